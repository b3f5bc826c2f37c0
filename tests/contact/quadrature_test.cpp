#include "contact/quadrature.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace palpate::contact {
namespace {

constexpr double kPi = std::numbers::pi;

/// A depth over the plane, zero beyond the square of edge 2 about the origin, and its exact volume.
struct Depth {
  const char* name;
  std::function<double(double, double)> at;
  double volume;
};

// Of a cap of radius R pressed by d: depth d - r^2 / 2R up to a^2 = 2 R d, volume pi a^4 / 4R.
Depth cap() {
  constexpr double a = 0.8, R = 5.0;
  return {"cap", [](double x, double y) { return std::max(0.0, (a * a - x * x - y * y) / (2.0 * R)); },
          kPi * std::pow(a, 4) / (4.0 * R)};
}
// A disc of one depth with walls all around.
Depth wall() {
  constexpr double a = 0.7, depth = 0.1;
  return {"wall", [](double x, double y) { return x * x + y * y < a * a ? depth : 0.0; },
          kPi * a * a * depth};
}
// A tilted disc: a wall of changing height.
Depth tilted_wall() {
  constexpr double a = 0.7, depth = 0.1;
  return {"tilted_wall", [](double x, double y) { return x * x + y * y < a * a ? depth * (1.0 + x) : 0.0; },
          kPi * a * a * depth};
}
// Pyramids of six sides, oblique to the pixels: straight creases and borders.
Depth pyramid() {
  constexpr double a = 0.75, depth = 0.2;  // inradius, height
  return {"pyramid",
          [](double x, double y) {
            double least = 1.0;
            for (int k = 0; k < 6; ++k) {
              const double angle = 0.2 + k * kPi / 3.0;
              least = std::min(least, 1.0 - (x * std::cos(angle) + y * std::sin(angle)) / a);
            }
            return depth * std::max(0.0, least);
          },
          2.0 * std::sqrt(3.0) * a * a * depth / 3.0};
}

struct Spread {
  double rms_error;             ///< of the sum over shifted grids
  double expected;              ///< by the grids' own estimates, RMS
  QuadratureEstimate estimate;  ///< of the last grid
};

// Over shifts, rotations, and pixels a tenth larger and smaller: the error of one size swings about the mean
// with the number of pixels that a circle covers, and straight lines may fit a grid of one direction.
// @param finer  the estimate is for pixels this many times finer
Spread over_grids(const Depth& depth, double pixel, double finer = 1.0) {
  constexpr int kGrids = 300;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  double errors = 0.0, expected = 0.0;
  Spread out{};
  for (int i = 0; i < kGrids; ++i) {
    const double h = pixel * (0.9 + 0.2 * part(random)), angle = 2.0 * kPi * part(random),
                 c = std::cos(angle), s = std::sin(angle);
    const ContactCamera camera =
        camera_of({{-1, -1}, {1, 1}, -1, 1}, h, Eigen::Vector2d(part(random), part(random)));
    DepthGrid grid;
    grid.start(camera);
    for (int row = 0; row < camera.height; ++row)
      for (int column = 0; column < camera.width; ++column) {
        const double u = camera.u(column), v = camera.v(row);
        grid.add(static_cast<std::uint32_t>(row * camera.width + column),
                 -depth.at(c * u - s * v, s * u + c * v));
      }
    out.estimate = grid.estimate();
    errors += std::pow(out.estimate.volume - depth.volume, 2);
    expected += std::pow(out.estimate.standard_error(h / finer), 2);
  }
  out.rms_error = std::sqrt(errors / kGrids);
  out.expected = std::sqrt(expected / kGrids);
  return out;
}

// What the pixels say of their own error, and of that of finer ones, is what the errors are.
TEST(Quadrature, EstimatesTheErrorOfItsOwnAndOfFinerPixels) {
  for (const Depth& depth : {cap(), wall(), tilted_wall(), pyramid()}) {
    const double coarse = 2.0 / 24;
    for (const double finer : {1.0, 2.0, 4.0}) {
      const double ratio =
          over_grids(depth, coarse, finer).expected / over_grids(depth, coarse / finer).rms_error;
      RecordProperty(fmt::format("{}_{}", depth.name, finer), fmt::format("{:.3f}", ratio));
      EXPECT_GT(ratio, 0.6) << depth.name << ", pixels " << finer << " times finer";
      EXPECT_LT(ratio, 1.7) << depth.name << ", pixels " << finer << " times finer";
    }
  }
}

// 0.102 (h / a)^2.5 of a cap, as derived.
TEST(Quadrature, OfACapIsTheDerivedLaw) {
  constexpr double a = 0.8, h = 2.0 / 64;
  const Spread spread = over_grids(cap(), h);
  const double law = 0.102 * std::pow(h / a, 2.5);
  EXPECT_NEAR(spread.expected / cap().volume / law, 1.0, 0.15);
  EXPECT_NEAR(spread.rms_error / cap().volume / law, 1.0, 0.25);
}

TEST(Quadrature, PixelsForAWantedErrorLeaveIt) {
  for (const Depth& depth : {cap(), wall(), pyramid()}) {
    const QuadratureEstimate estimate = over_grids(depth, 2.0 / 40).estimate;
    for (const double wanted : {1e-2, 1e-3}) {
      const double pixel = estimate.pixel_for(wanted);
      EXPECT_NEAR(estimate.standard_error(pixel) / (wanted * estimate.volume), 1.0, 0.01) << depth.name;
      const double error = over_grids(depth, pixel).rms_error / depth.volume;
      EXPECT_LT(error, 2.0 * wanted) << depth.name;
      EXPECT_GT(error, 0.3 * wanted) << depth.name << ": finer than asked for";
    }
  }
}

TEST(Quadrature, OfNothingIsNothing) {
  DepthGrid grid;
  grid.start(camera_of({{-1, -1}, {1, 1}, -1, 1}, 16, {0, 0}));
  grid.add(5, 0.3);  // apart
  const QuadratureEstimate estimate = grid.estimate();
  EXPECT_EQ(estimate.volume, 0.0);
  EXPECT_EQ(estimate.standard_error(0.1), 0.0);
  EXPECT_EQ(estimate.pixel_for(1e-3), 0.0);
}

// Lengths a thousand times as large: pixels as well, shares the same.
TEST(Quadrature, KnowsNoUnit) {
  const auto of_size = [](double size) {
    DepthGrid grid;
    const ContactCamera camera = camera_of({{-size, -size}, {size, size}, -size, size}, 40, {0.3, 0.6});
    grid.start(camera);
    for (int row = 0; row < camera.height; ++row)
      for (int column = 0; column < camera.width; ++column)
        grid.add(static_cast<std::uint32_t>(row * camera.width + column),
                 -size * cap().at(camera.u(column) / size, camera.v(row) / size));
    return grid.estimate();
  };
  const QuadratureEstimate one = of_size(1.0), large = of_size(1e3), small = of_size(1e-3);
  EXPECT_NEAR(large.pixel_for(1e-3) / one.pixel_for(1e-3), 1e3, 1e-6 * 1e3);
  EXPECT_NEAR(small.pixel_for(1e-3) / one.pixel_for(1e-3), 1e-3, 1e-6 * 1e-3);
}

}  // namespace
}  // namespace palpate::contact
