#pragma once
#include <algorithm>
#include <cstdint>

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
    if (!(gap < 0.0)) return;
    const int row = static_cast<int>(pixel) / width_, column = static_cast<int>(pixel) % width_;
    depth_(column + kRim, row + kRim) -= gap;
    rows_.take(row);
    columns_.take(column);
  }
  QuadratureEstimate estimate() const;

 private:
  /// Where the depth is not zero.
  struct Span {
    int first = 1, last = 0;
    bool is_empty() const { return first > last; }
    void take(int i) {
      first = is_empty() ? i : std::min(first, i);
      last = std::max(last, i);
    }
  };
  static constexpr int kRim = 2;  ///< of zeros: a second difference next to the image has neighbours

  int width_ = 0, height_ = 0;
  double pixel_ = 0.0;
  Eigen::ArrayXXd depth_;  ///< column by row, so that a row of pixels is contiguous, within a rim [m]
  Span rows_, columns_;
};

}  // namespace palpate::contact
