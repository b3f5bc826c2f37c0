#include "contact/gpu_hardware.h"

#include <filesystem>

#include "contact/depth_image.h"
#include "palpate/contact/gpu_available.h"
#include "palpate/core/error.h"
#include "palpate/gl/context.h"

namespace palpate::contact {
namespace {

/// Device files of Linux's graphics drivers, and of NVIDIA's own.
bool shows_a_device() {
  std::error_code ignored;
  if (std::filesystem::exists("/dev/nvidiactl", ignored)) return true;
  for (const auto& entry : std::filesystem::directory_iterator("/dev/dri", ignored))
    if (entry.path().filename().string().starts_with("renderD")) return true;
  return false;
}

bool finds_gpu_hardware() {
  static const bool found = [] {
    if (!shows_a_device()) return false;
    try {
      return !gl::Context::shared().info().software;
    } catch (const Error&) { return false; }
  }();
  return found;
}

}  // namespace

GpuProbe& gpu_probe() {
  static GpuProbe probe = finds_gpu_hardware;
  return probe;
}

bool has_gpu_hardware() { return gpu_probe()(); }

GpuDevice open_gpu() {
  make_gpu_image();
  return gpu_device();
}

GpuDevice gpu_device() {
  if (!gl::Context::opened()) return {};
  const gl::ContextInfo& info = gl::Context::shared().info();
  return {info.renderer, info.version, info.software};
}

}  // namespace palpate::contact
