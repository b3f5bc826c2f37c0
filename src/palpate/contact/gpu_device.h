#pragma once
#include <string>

namespace palpate::contact {

/// Whether this build has contact images (PALPATE_WITH_GL); without it method "image" throws Error.
bool gpu_available();

/// What draws the images of this process, by its driver's own words.
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
