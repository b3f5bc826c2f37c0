#pragma once
#include <string>

namespace palpate::contact {

/// Whether this build has contact images on the GPU (PALPATE_WITH_GL); without it method "gpu" throws Error.
bool gpu_available();

/// Whether there is a GPU, not only Mesa's software rasteriser.  Nothing is opened where the machine shows no
/// device; else the GL context is.
bool has_gpu_hardware();

/// What draws the images of this process on the GPU, by its driver's own words.
struct GpuDevice {
  std::string name, driver;
  bool software = false;  ///< a rasteriser on the processor
};
/// Makes ready what draws them, as the first image does otherwise.
/// @throws Error where that cannot be, saying why
GpuDevice open_gpu();
/// Empty names where nothing was drawn.
GpuDevice gpu_device();

}  // namespace palpate::contact
