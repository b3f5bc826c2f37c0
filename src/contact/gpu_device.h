#pragma once
#include <string>

namespace palpate::contact {

/// Returns whether this build has contact images (PALPATE_WITH_GL); without them method "image" throws Error.
bool gpu_available();

/// Renderer of this process's contact images, as its driver reports it.
struct GpuDevice {
  std::string name, driver;
  bool software = false;  ///< True: software rasteriser on the CPU.
};
/// Initialises the renderer, which the first image does otherwise.
/// @throws Error where no renderer can be opened, with the reason
GpuDevice open_gpu();
/// Returns the renderer; empty names where nothing was drawn yet.
GpuDevice gpu_device();

}  // namespace palpate::contact
