#include "contact/quadrature.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

// A region's force is k times its overlap volume, the integral of the depth f, which the pixels sum up on a
// square grid of edge h.  f is continuous and vanishes at the border of the overlap; its slope jumps there
// and at the skins' creases.  Of a grid that lies at random the sum is right in the mean and has the variance
//
//     Var = sum over integers k != 0 of |F(k / h)|^2,        F the Fourier transform of f
//
// (Kendall 1948 and Matheron 1965 for indicator functions).  Far out F belongs to the lines where f is not
// smooth.  Across a line along which the slope jumps by J, F falls as J / (2 pi r)^2; of a curved line of
// length l the mean of |F|^2 over all directions is 2 l J^2 / (2 pi r)^5.  Where f itself jumps by D (a wall)
// it is 2 l D^2 / (2 pi r)^3.  So with  K = integral of J^2 dl  and  Q = integral of D^2 dl
//
//     Var = 2 (K h^5 S5 / (2 pi)^5 + Q h^3 S3 / (2 pi)^3),       Ss = sum of |k|^-s = 4 zeta(s/2) beta(s/2).
//
// Of a spherical cap with a contact of radius a this is a relative error of 0.102 (h/a)^2.5: thirteen pixels
// across the contact leave a thousandth.
//
// K and Q are read from the pixels.  A crease between pixels of a row, at a random place, leaves second
// differences whose squares sum up to 2/3 (J cos)^2 h^2, and l |cos| / h rows cross it; with the columns, and
// the mean of |cos|^3 + |sin|^3, 8 / (3 pi):
//
//     sum of squared second differences = 16 / (9 pi) K h.
//
// A wall shows as a last pixel whose depth is more than the slope explains by which the depth went up to it;
// twice that slope is allowed for, for a skin is not smooth.  Rows and columns cross it 4 / pi l / h times.

namespace palpate::contact {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr double kS5 = 5.0903, kS3 = 9.0336;

}  // namespace

double QuadratureEstimate::standard_error(double h) const {
  return std::sqrt(2.0 * (kinks * std::pow(h, 5) * kS5 / std::pow(kTwoPi, 5) +
                          steps * h * h * h * kS3 / std::pow(kTwoPi, 3)));
}

double QuadratureEstimate::pixel_for(double relative) const {
  if (!(volume > 0.0) || !(kinks > 0.0 || steps > 0.0)) return 0.0;
  // The error grows with h: bisection of its logarithm.
  const double wanted = relative * volume;
  double high = std::cbrt(volume);
  while (standard_error(high) < wanted) high *= 2.0;
  double low = high;
  while (standard_error(low) > wanted) low *= 0.5;
  while (high > 1.001 * low) {
    const double middle = std::sqrt(low * high);
    (standard_error(middle) > wanted ? high : low) = middle;
  }
  return low;
}

void DepthGrid::start(const ContactCamera& camera) {
  width_ = camera.width;
  height_ = camera.height;
  pixel_ = camera.pixel;
  depth_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), 0.0);
}

QuadratureEstimate DepthGrid::estimate() const {
  double sum = 0.0, second = 0.0, walls = 0.0;
  for (const double f : depth_) sum += f;
  // One row or column; beyond both ends there is nothing.
  const auto line = [&](std::size_t first, std::size_t stride, int count) {
    const auto at = [&](int i) {
      return i < 0 || i >= count ? 0.0 : depth_[first + static_cast<std::size_t>(i) * stride];
    };
    for (int i = -1; i <= count; ++i) {
      const double before = at(i - 1), f = at(i), after = at(i + 1);
      const double bend = before - 2.0 * f + after;
      second += bend * bend;
      if (f <= 0.0) continue;
      for (const auto& [outside, inside] : {std::array{before, after}, std::array{after, before}})
        if (outside <= 0.0 && inside > 0.0) {
          const double wall = std::max(0.0, f - 2.0 * std::abs(inside - f));
          walls += wall * wall;
        }
    }
  };
  for (int row = 0; row < height_; ++row)
    line(static_cast<std::size_t>(row) * static_cast<std::size_t>(width_), 1, width_);
  for (int column = 0; column < width_; ++column)
    line(static_cast<std::size_t>(column), static_cast<std::size_t>(width_), height_);
  QuadratureEstimate out;
  out.volume = sum * pixel_ * pixel_;
  out.kinks = 9.0 * std::numbers::pi / 16.0 * second / pixel_;
  out.steps = 0.25 * std::numbers::pi * walls * pixel_;
  return out;
}

}  // namespace palpate::contact
