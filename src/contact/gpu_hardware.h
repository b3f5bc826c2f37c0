#pragma once

namespace palpate::contact {

/// What has_gpu_hardware() asks: the machine, or in tests another one.
using GpuProbe = bool (*)();
GpuProbe& gpu_probe();

}  // namespace palpate::contact
