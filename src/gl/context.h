#pragma once
#include <memory>
#include <string>

#include "palpate/core/error.h"

/// Headless OpenGL: one EGL context without a window, created on first use and current on one thread at a
/// time.
namespace palpate::gl {

/// Properties of the context.
struct ContextInfo {
  std::string platform;                   ///< EGL platform: "device" or "surfaceless".
  std::string vendor, renderer, version;  ///< GL_VENDOR, GL_RENDERER, GL_VERSION.
  bool software = false;  ///< Whether it is a software rasteriser (llvmpipe, softpipe, swrast).
};

/// The GPU was lost or reset: all objects of the context are gone.
class ContextLost : public Error {
 public:
  using Error::Error;
};

/// Kinds of objects of the context.
enum class ObjectKind { kBuffer, kVertexArray, kTexture, kFramebuffer, kProgram, kQuery };

/// The process's GL context (OpenGL 4.5 core, or 4.3).  No GL library is loaded before the first call of
/// shared().  It is current on one thread: make_current() acquires it, release() lets another thread acquire
/// it.
class Context {
 public:
  /// Creates the context at the first call, and makes it current on the calling thread.  A hardware device is
  /// preferred; else Mesa's software rasteriser is used.  Counts "gl.context".
  /// @throws Error when no EGL library, device or OpenGL >= 4.3 is found, with the package that provides it,
  /// and where the context is current on another thread
  static Context& shared();
  static bool opened();  ///< Whether the context exists; does not create it.
  /// Releases the context, if it exists and is current on this thread.  Never throws.
  static void release_here();
  /// Deletes an object of the context: now where the context is current on this thread, else when it becomes
  /// current next.  Without effect where the context is gone, and its objects with it.
  static void destroy(ObjectKind kind, unsigned id);

  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  void make_current();  ///< @throws Error where it is current on another thread
  void release();       ///< Makes it no longer current on this thread.
  const ContextInfo& info() const { return info_; }

 private:
  Context();
  static Context& instance();
  struct Handles;
  std::unique_ptr<Handles> handles_;
  ContextInfo info_;
};

/// Checks that a shared library can be loaded.
/// @throws Error with the Debian package that provides it, where it cannot
void require_library(const std::string& file, const std::string& package);

/// Checks for a reset of the GPU.  @param what  name of the work  @throws ContextLost where the driver
/// reports one
void check_context(const char* what);

/// Throws InternalError when GL recorded an error since the last call; `what` is the name of the work.
void check_errors(const char* what);

}  // namespace palpate::gl
