#include "contact/depth_image.h"
#include "contact/gpu_device.h"
#include "palpate/core/error.h"

// Replaces the images in a build without OpenGL.

namespace palpate::contact {

bool gpu_available() { return false; }
GpuDevice gpu_device() { return {}; }
GpuDevice open_gpu() {
  make_depth_image();
  return {};
}

std::unique_ptr<DepthImage> make_depth_image() {
  fail(
      "contact method = \"image\" is not built in; use \"distance\", or configure with -DPALPATE_WITH_GL=ON "
      "(packages libepoxy-dev, libegl-dev)");
}

}  // namespace palpate::contact
