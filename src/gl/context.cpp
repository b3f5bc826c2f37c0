#include "gl/context.h"

#include <dlfcn.h>
#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <mutex>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "core/counters.h"
#include "gl/display_order.h"
#include "palpate/core/error.h"

namespace palpate::gl {
namespace {

constexpr const char* kMesaPackages =
    "install libegl1, libegl-mesa0, libgl1 and libgl1-mesa-dri (Mesa's software rasteriser needs no GPU)";

bool has_word(const char* list, std::string_view word) {
  if (!list) return false;
  std::string_view rest(list);
  while (!rest.empty()) {
    const auto end = std::min(rest.find(' '), rest.size());
    if (rest.substr(0, end) == word) return true;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return false;
}

struct Candidate {
  DisplayKind kind;
  EGLDisplay display;
  const char* platform() const { return kind == DisplayKind::kSurfaceless ? "surfaceless" : "device"; }
};

/// Returns displays that need no window system, hardware first.  (eglGetDisplay(EGL_DEFAULT_DISPLAY) fails
/// without a window system.)
std::vector<Candidate> candidates() {
  const char* client = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  std::vector<Candidate> out;
  if (has_word(client, "EGL_EXT_platform_device") &&
      (has_word(client, "EGL_EXT_device_enumeration") || has_word(client, "EGL_EXT_device_base"))) {
    EGLDeviceEXT devices[16];
    EGLint count = 0;
    if (eglQueryDevicesEXT(16, devices, &count)) {
      for (int i = 0; i < count; ++i) {
        const bool is_software =
            has_word(eglQueryDeviceStringEXT(devices[i], EGL_EXTENSIONS), "EGL_MESA_device_software");
        out.push_back({is_software ? DisplayKind::kSoftwareDevice : DisplayKind::kHardwareDevice,
                       eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr)});
      }
    }
  }
  if (has_word(client, "EGL_MESA_platform_surfaceless"))
    out.push_back({DisplayKind::kSurfaceless,
                   eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr)});
  std::stable_sort(out.begin(), out.end(),
                   [](const Candidate& a, const Candidate& b) { return is_tried_before(a.kind, b.kind); });
  return out;
}

/// Creates a core context of version 4.5, else 4.3 (compute shaders and shader storage).  Without a surface:
/// EGL_KHR_surfaceless_context.
EGLContext create_context(EGLDisplay display) {
  if (!eglBindAPI(EGL_OPENGL_API)) return EGL_NO_CONTEXT;
  const EGLint config_wanted[] = {EGL_SURFACE_TYPE, EGL_DONT_CARE, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT,
                                  EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  // Without a config: EGL_KHR_no_config_context.
  if (!eglChooseConfig(display, config_wanted, &config, 1, &count) || count < 1) config = nullptr;
  for (const int minor : {5, 3})
    for (const bool told_of_resets : {true, false}) {  // EGL 1.5
      std::vector<EGLint> requested = {EGL_CONTEXT_MAJOR_VERSION,       4,
                                       EGL_CONTEXT_MINOR_VERSION,       minor,
                                       EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT};
      if (told_of_resets)
        requested.insert(requested.end(),
                         {EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY, EGL_LOSE_CONTEXT_ON_RESET});
      requested.push_back(EGL_NONE);
      if (const EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, requested.data()))
        return context;
    }
  return EGL_NO_CONTEXT;
}

bool is_software(std::string renderer) {
  std::transform(renderer.begin(), renderer.end(), renderer.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const char* name : {"llvmpipe", "softpipe", "swrast", "software"})
    if (renderer.find(name) != std::string::npos) return true;
  return false;
}

std::string gl_string(GLenum name) {
  const auto* text = reinterpret_cast<const char*>(glGetString(name));
  return text ? text : "";
}

/// Deletes an object.  @pre the context is current on this thread
void destroy_now(ObjectKind kind, unsigned id) {
  switch (kind) {
    case ObjectKind::kBuffer: glDeleteBuffers(1, &id); break;
    case ObjectKind::kVertexArray: glDeleteVertexArrays(1, &id); break;
    case ObjectKind::kTexture: glDeleteTextures(1, &id); break;
    case ObjectKind::kFramebuffer: glDeleteFramebuffers(1, &id); break;
    case ObjectKind::kProgram: glDeleteProgram(id); break;
    case ObjectKind::kQuery: glDeleteQueries(1, &id); break;
  }
}

std::atomic<bool> g_opened = false;

}  // namespace

struct Context::Handles {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
  std::atomic<std::thread::id> owner;
  std::mutex abandoned_mutex;
  std::vector<std::pair<ObjectKind, unsigned>> abandoned;  ///< Objects to be deleted by the next owner.

  void destroy_abandoned() {
    std::vector<std::pair<ObjectKind, unsigned>> all;
    {
      const std::scoped_lock lock(abandoned_mutex);
      all.swap(abandoned);
    }
    for (const auto& [kind, id] : all) destroy_now(kind, id);
  }
};

// libepoxy opens its libraries itself, but aborts the process where they are missing; so they are tried
// first.
void require_library(const std::string& file, const std::string& package) {
  void* handle = dlopen(file.c_str(), RTLD_LAZY | RTLD_LOCAL);
  if (!handle)
    fail("OpenGL without a display needs {}, which cannot be loaded ({}); install the package {}", file,
         dlerror(), package);
  dlclose(handle);
}

Context& Context::instance() {
  static Context context;
  return context;
}

Context& Context::shared() {
  Context& context = instance();
  context.make_current();
  return context;
}

void Context::release_here() {
  if (opened()) instance().release();
}

void Context::destroy(ObjectKind kind, unsigned id) {
  if (!opened()) return;
  Handles& handles = *instance().handles_;
  if (handles.owner.load() == std::this_thread::get_id()) return destroy_now(kind, id);
  const std::scoped_lock lock(handles.abandoned_mutex);
  handles.abandoned.emplace_back(kind, id);
}

bool Context::opened() { return g_opened; }

Context::Context() : handles_(std::make_unique<Handles>()) {
  require_library("libEGL.so.1", "libegl1");
  require_library("libGL.so.1", "libgl1");
  std::string tried;
  for (const Candidate& candidate : candidates()) {
    EGLint major = 0, minor = 0;
    if (candidate.display == EGL_NO_DISPLAY || !eglInitialize(candidate.display, &major, &minor)) {
      tried += std::string(tried.empty() ? "" : ", ") + candidate.platform() + ": no display";
      continue;
    }
    const EGLContext context = create_context(candidate.display);
    if (context == EGL_NO_CONTEXT) {
      tried += std::string(tried.empty() ? "" : ", ") + candidate.platform() + ": no OpenGL 4.3";
      continue;
    }
    handles_->display = candidate.display;
    handles_->context = context;
    info_.platform = candidate.platform();
    break;
  }
  if (handles_->context == EGL_NO_CONTEXT)
    fail("no EGL device supports OpenGL 4.3 without a display (tried {}); {}", tried.empty() ? "none" : tried,
         kMesaPackages);
  make_current();
  info_.vendor = gl_string(GL_VENDOR);
  info_.renderer = gl_string(GL_RENDERER);
  info_.version = gl_string(GL_VERSION);
  info_.software = is_software(info_.renderer);
  g_opened = true;
  counters::count("gl.context");
}

// Static object: constructed after EGL's libraries were loaded, so it is destroyed before their exit handlers
// run.
Context::~Context() {
  g_opened = false;
  if (handles_->context == EGL_NO_CONTEXT) return;
  eglMakeCurrent(handles_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(handles_->display, handles_->context);
  eglTerminate(handles_->display);
}

void Context::make_current() {
  const auto self = std::this_thread::get_id();
  if (handles_->owner.load() == self) return;
  std::thread::id none;
  if (!handles_->owner.compare_exchange_strong(none, self))
    fail(
        "OpenGL is in use by another thread of this process, and only one can use it at a time: step "
        "simulations with method = \"image\", and draw pictures, one after another, or each in a separate "
        "process");
  if (!eglMakeCurrent(handles_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, handles_->context)) {
    handles_->owner = std::thread::id{};
    PALPATE_CHECK(false, "eglMakeCurrent failed, EGL error {:#x}", static_cast<unsigned>(eglGetError()));
  }
  handles_->destroy_abandoned();
}

void Context::release() {
  if (handles_->owner.load() != std::this_thread::get_id()) return;
  eglMakeCurrent(handles_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  handles_->owner = std::thread::id{};
}

void check_context(const char* what) {
  // Needs OpenGL 4.5; older versions report a reset only through errors.
  if (epoxy_gl_version() < 45 || glGetGraphicsResetStatus() == GL_NO_ERROR) return;
  throw ContextLost(fmt::format("{}: the GPU {} was reset by its driver, and its data are lost", what,
                                Context::shared().info().renderer));
}

void check_errors(const char* what) {
  const GLenum error = glGetError();
  PALPATE_CHECK(error == GL_NO_ERROR, "OpenGL error {:#x} in {}", error, what);
}

}  // namespace palpate::gl
