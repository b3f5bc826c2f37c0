#include "contact/quadrature.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

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
  depth_.setZero(width_ + 2 * kRim, height_ + 2 * kRim);
  rows_ = columns_ = {};
}

namespace {

/// Square of the depth f of a wall's last pixel, with nothing on one side and `inside` on the other.
double squared_wall(double f, double inside) {
  const double wall = std::max(0.0, f - 2.0 * std::abs(inside - f));
  return wall * wall;
}

}  // namespace

QuadratureEstimate DepthGrid::estimate() const {
  QuadratureEstimate out;
  if (rows_.is_empty()) return out;
  double sum = 0.0, second = 0.0, walls = 0.0;
  // One pixel beyond the depths on all sides: there the second differences begin.
  const int left = columns_.first - 1 + kRim, count = columns_.last - columns_.first + 3;
  for (int row = rows_.first - 1 + kRim; row <= rows_.last + 1 + kRim; ++row) {
    const auto here = depth_.col(row).segment(left, count);
    const auto west = depth_.col(row).segment(left - 1, count),
               east = depth_.col(row).segment(left + 1, count);
    const auto south = depth_.col(row - 1).segment(left, count),
               north = depth_.col(row + 1).segment(left, count);
    sum += here.sum();
    second += (west - 2.0 * here + east).square().sum() + (south - 2.0 * here + north).square().sum();
    for (int i = 0; i < count; ++i) {
      const double f = here[i];
      if (f <= 0.0) continue;
      for (const auto& [p, q] : {std::pair{west[i], east[i]}, std::pair{south[i], north[i]}}) {
        if (p <= 0.0 && q > 0.0) walls += squared_wall(f, q);
        if (q <= 0.0 && p > 0.0) walls += squared_wall(f, p);
      }
    }
  }
  out.volume = sum * pixel_ * pixel_;
  out.kinks = 9.0 * std::numbers::pi / 16.0 * second / pixel_;
  out.steps = 0.25 * std::numbers::pi * walls * pixel_;
  return out;
}

}  // namespace palpate::contact
