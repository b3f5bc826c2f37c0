#include "contact/depth_image.h"
#include "palpate/contact/gpu_available.h"
#include "palpate/core/error.h"

// Replaces the images on the GPU in a build without OpenGL.

namespace palpate::contact {

bool gpu_available() { return false; }
bool has_gpu_hardware() { return false; }
GpuDevice gpu_device() { return {}; }
GpuDevice open_gpu() {
  make_gpu_image();
  return {};
}

std::unique_ptr<DepthImage> make_gpu_image() {
  fail(
      "contact method = \"gpu\" is not built in; take \"cpu\", or configure with -DPALPATE_WITH_GL=ON "
      "(packages "
      "libepoxy-dev, libegl-dev)");
}

}  // namespace palpate::contact
