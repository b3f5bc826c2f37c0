#include "contact/gpu_device.h"

#include "contact/depth_image.h"
#include "gl/context.h"

namespace palpate::contact {

bool gpu_available() { return true; }

GpuDevice open_gpu() {
  make_depth_image();
  return gpu_device();
}

GpuDevice gpu_device() {
  if (!gl::Context::opened()) return {};
  const gl::ContextInfo& info = gl::Context::shared().info();
  return {info.renderer, info.version, info.software};
}

}  // namespace palpate::contact
