#pragma once

namespace palpate::gl {

/// Kind of a display that needs no window system.
enum class DisplayKind {
  kSoftwareDevice,  ///< EGL_MESA_device_software: a rasteriser on the CPU.
  kSurfaceless,     ///< Mesa's surfaceless platform: a GPU that Mesa drives if there is one, else software.
  kHardwareDevice
};

/// Strict order of the kinds: hardware first, then possibly software, then software.
constexpr bool is_tried_before(DisplayKind a, DisplayKind b) {
  const auto rank = [](DisplayKind kind) {
    return kind == DisplayKind::kHardwareDevice ? 0 : kind == DisplayKind::kSurfaceless ? 1 : 2;
  };
  return rank(a) < rank(b);
}

}  // namespace palpate::gl
