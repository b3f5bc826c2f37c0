#pragma once
#include <memory>
#include <string>

#include "palpate/core/error.h"

/// Headless OpenGL: one EGL context without a window, opened on first use and owned by one thread at a time.
namespace palpate::gl {

/// What the context turned out to be.
struct ContextInfo {
  std::string platform;                   ///< "device" or "surfaceless"
  std::string vendor, renderer, version;  ///< of GL_VENDOR, GL_RENDERER, GL_VERSION
  bool software = false;                  ///< a software rasteriser (llvmpipe, softpipe, swrast)
};

/// The GPU is gone or has been reset: nothing that was made in the context is there any more.
class ContextLost : public Error {
 public:
  using Error::Error;
};

/// The process's one GL context (OpenGL 4.5 core, or 4.3).  No GL library is loaded before the first call of
/// `shared`. It is current on one thread: `make_current` takes it, `release` lets another thread take it.
class Context {
 public:
  /// Opens the context at the first call and makes it current on the calling thread; later calls make it
  /// current there. A hardware device is preferred; else Mesa's software rasteriser.  Counts "gl.context".
  /// @throws Error when no EGL library, device or OpenGL >= 4.3 is found, naming the package that brings it.
  static Context& shared();
  static bool opened();  ///< asks without opening

  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  void make_current();  ///< @throws InternalError when another thread holds it
  void release();       ///< no longer current on this thread
  const ContextInfo& info() const { return info_; }

 private:
  Context();
  struct Handles;
  std::unique_ptr<Handles> handles_;
  ContextInfo info_;
};

/// The libraries that a context needs, by file name.
/// @throws Error with the Debian package of the first that cannot be loaded.
void require_library(const std::string& file, const std::string& package);

/// @throws ContextLost where the driver says that it was reset; `what` names the work
void check_context(const char* what);

/// Throws InternalError when GL recorded an error since the last call; `what` names the work.
void check_errors(const char* what);

}  // namespace palpate::gl
