#pragma once
#include <vector>

#include "contact/contact_view.h"

namespace palpate::contact {

/// What a sum over pixels says about its own error, and about the pixels that a wanted error needs
/// (quadrature.cpp).
struct QuadratureEstimate {
  double volume = 0.0;  ///< overlap [m^3]
  double kinks =
      0.0;  ///< integral of the squared jump of the depth's slope along the lines where it jumps [m]
  double steps = 0.0;  ///< integral of the depth's own squared jump, along walls [m^3]

  /// Standard error of the volume that pixels of this edge sum up [m^3].
  double standard_error(double pixel) const;
  /// The pixels' edge for a standard error of `relative` times the volume [m]; 0 where nothing overlaps.
  double pixel_for(double relative) const;
};

/// Depths of a region on its pixels, for the estimate.
class DepthGrid {
 public:
  void start(const ContactCamera& camera);
  /// Adds depth where two layers of a pixel overlap.
  void add(std::uint32_t pixel, double gap) {
    if (gap < 0.0) depth_[pixel] -= gap;
  }
  QuadratureEstimate estimate() const;

 private:
  int width_ = 0, height_ = 0;
  double pixel_ = 0.0;
  std::vector<double> depth_;  ///< row by row [m]
};

}  // namespace palpate::contact
