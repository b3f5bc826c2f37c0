#pragma once

namespace palpate::contact {

/// Whether this build has contact images on the GPU (PALPATE_WITH_GL); without it method "gpu" throws Error.
bool gpu_available();

/// Whether there is a GPU, not only Mesa's software rasteriser.  Nothing is opened where the machine shows no
/// device; else the GL context is.
bool has_gpu_hardware();

}  // namespace palpate::contact
