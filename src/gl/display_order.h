#pragma once

namespace palpate::gl {

/// A display that needs no window system.
enum class DisplayKind {
  kSoftwareDevice,  ///< EGL_MESA_device_software: a rasteriser on the processor
  kSurfaceless,     ///< Mesa's platform: it takes a GPU where there is one that Mesa drives, else software
  kHardwareDevice
};

/// Hardware before what may be software before what is.  A strict order of the kinds.
constexpr bool is_tried_before(DisplayKind a, DisplayKind b) {
  const auto rank = [](DisplayKind kind) {
    return kind == DisplayKind::kHardwareDevice ? 0 : kind == DisplayKind::kSurfaceless ? 1 : 2;
  };
  return rank(a) < rank(b);
}

}  // namespace palpate::gl
