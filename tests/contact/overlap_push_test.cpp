#include "contact/overlap_push.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

using namespace palpate;
using contact::ContactCamera;
using contact::Hit;

namespace {

using Height = std::function<double(double, double)>;

constexpr double kCandidateGap = 0.02;

/// What all pixels of a square of edge 2 push, its grid moved by a part of a pixel.
Vec3 push(const Height& a, const Height& b, int pixels, double shift = 0.0, double closer = 0.0) {
  ContactCamera camera;
  camera.width = camera.height = pixels;
  camera.pixel = 2.0 / (pixels - 1);
  camera.u0 = camera.v0 = -1.0 - shift * camera.pixel;
  std::vector<Hit> hits;
  for (int row = 0; row < pixels; ++row)
    for (int column = 0; column < pixels; ++column) {
      Hit hit{};
      hit.at.u = camera.u(column);
      hit.at.v = camera.v(row);
      hit.at.w_a = a(hit.at.u, hit.at.v);
      hit.at.w_b = b(hit.at.u, hit.at.v);
      hit.pixel = static_cast<std::uint32_t>(row * pixels + column);
      hit.area = camera.pixel * camera.pixel;
      if (hit.at.gap() < kCandidateGap) hits.push_back(hit);
    }
  contact::OverlapPush rule;
  contact::PixelPush sum;
  for (const contact::PixelPush& one : rule.find(hits, camera, kCandidateGap, closer)) sum.add(one);
  return sum.integral();
}

double bowl(double x, double y) { return 0.2 - 0.5 * (x * x + y * y); }  // a depth: above 0 within 0.63
constexpr double kBowl = M_PI * 0.04;  // its volume, pi d^2 / (2 c), c = 1/2

}  // namespace

// where the depth ends smoothly, int d grad (w_a - w_b) = 0, so that the slopes of either skin say the same
TEST(OverlapPush, OfASlopeIsTheVolumeTimesTheSlope) {
  const Height slope = [](double x, double y) { return 0.3 * x - 0.2 * y; };
  const Height over = [&](double x, double y) { return slope(x, y) - bowl(x, y); };
  const Vec3 expected = kBowl * Vec3(-0.3, 0.2, 1.0);
  EXPECT_LT((push(over, slope, 64) - expected).norm(), 2e-3 * kBowl);
  EXPECT_LT((push(over, slope, 256) - expected).norm(), 2e-4 * kBowl);
  // the same slope on the other skin alone: the bowl's own slopes cancel
  const Height flat = [](double, double) { return 0.0; };
  const Vec3 upright = push([](double x, double y) { return -bowl(x, y); }, flat, 64, 0.37);
  EXPECT_LT(upright.head<2>().norm(), 1e-3 * kBowl);
}

// a wall of height 0.5 along x = 0.1 in both skins: it is as high wherever the pixels stand
TEST(OverlapPush, MissesNoWall) {
  const Height wall = [](double x, double) { return x > 0.1 ? 0.5 : 0.0; };
  const Height over = [&](double x, double y) { return wall(x, y) - bowl(x, y); };
  const double half = std::sqrt(2.0 * (0.2 - 0.005));                 // of the wall's length that is pressed
  const double expected = -0.5 * (4.0 / 3.0) * half * (0.2 - 0.005);  // int of bowl(0.1, y) along it
  for (const double shift : {0.0, 0.2, 0.4, 0.6, 0.8}) {
    const Vec3 sum = push(over, wall, 64, shift);
    EXPECT_NEAR(sum.x(), expected, 0.02 * std::abs(expected)) << shift;
    EXPECT_NEAR(sum.y(), 0.0, 0.01 * std::abs(expected)) << shift;
  }
}

// the step of a staircase sinks away from under the other skin: no step of the push as its depth ends, nor
// as it leaves the candidates
TEST(OverlapPush, GoesOnAsDepthAndCandidatesEnd) {
  const Height ground = [](double, double) { return 0.0; };
  const auto at = [&](double lift) {
    const Height stairs = [&](double x, double) { return x > 0.1 ? -0.1 + lift : -0.2; };
    return push(stairs, ground, 64);
  };
  const double scale = at(0.0).norm();
  Vec3 before = at(0.0);
  double most = 0.0;
  for (int i = 1; i <= 2000; ++i) {
    const Vec3 now = at(0.15 * i / 2000);
    most = std::max(most, (now - before).norm());
    before = now;
  }
  EXPECT_GT(most, 0.0);
  EXPECT_LT(most, 2e-3 * scale);
}

TEST(OverlapPush, OfPixelsThatDoNotPressIsZero) {
  const Vec3 sum = push([](double, double) { return 0.01; }, [](double x, double) { return 1e-3 * x; }, 16);
  EXPECT_EQ(sum, Vec3(Vec3::Zero()));
}

// however few pixels see two planes that meet in a wedge, and wherever these stand
TEST(OverlapPush, OfPlanesIsExact) {
  const Height below = [](double x, double y) { return 0.3 * x - 0.2 * y; };
  const Height over = [&](double x, double y) { return below(x, y) + (x > 0.77 ? -0.01 : 1.0); };
  for (const double shift : {0.1, 0.5, 0.9})
    for (const int pixels : {16, 20}) {
      const Vec3 sum = push(over, below, pixels, shift);
      EXPECT_GT(sum.z(), 0.0);
      EXPECT_NEAR(sum.x() / sum.z(), -0.3, 1e-12) << pixels << " " << shift;
      EXPECT_NEAR(sum.y() / sum.z(), 0.2, 1e-12) << pixels << " " << shift;
    }
}

// what is a little apart pushes where the skins are taken to be closer, as if moved
TEST(OverlapPush, TakesSkinsToBeCloser) {
  const Height slope = [](double x, double y) { return 0.3 * x - 0.2 * y; };
  const auto over = [&](double by) -> Height {
    return [&slope, by](double x, double y) { return slope(x, y) + by - bowl(x, y); };
  };
  const Vec3 moved = push(over(0.2), slope, 64, 0.3, 0.01), there = push(over(0.19), slope, 64, 0.3);
  EXPECT_GT(moved.z(), 0.0);
  EXPECT_LT((moved - there).norm(), 1e-3 * there.norm());  // but for the width of the border's weights
  EXPECT_EQ(push(over(0.2), slope, 64, 0.3).z(), 0.0);
}
