// The lanes over a chunk of faces say what its faces say one by one, with every instruction set to the last
// bit: a chunk's area decides whether its faces are looked at one by one at all.
#include "contact/face_kernels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <vector>

#include "contact/contact_view.h"
#include "palpate/core/instructions.h"

using namespace palpate;
using namespace palpate::contact;

namespace {

std::vector<const FaceKernels*> kernels_of_each_set() {
  std::vector<const FaceKernels*> out;
  for (const char* name : {"baseline", "avx2", "avx512"}) {
    Instructions set;
    if (!find_instructions(name, set)) continue;
    setenv("PALPATE_INSTRUCTIONS", name, 1);
    out.push_back(&best_face_kernels());
    unsetenv("PALPATE_INSTRUCTIONS");
    for (std::size_t i = 0; i + 1 < out.size(); ++i) EXPECT_NE(out[i], out.back()) << name;
  }
  EXPECT_FALSE(out.empty());
  return out;
}

std::vector<double> random_numbers(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<double> out(count);
  for (double& x : out) x = uniform(random);
  return out;
}

}  // namespace

TEST(FaceKernels, PointsInAxes) {
  constexpr int kCount = 301;
  const std::vector<double> world = random_numbers(3 * kCount, 1);
  const ContactAxes axes(Vec3(0.7, -0.4, 0.2), Vec3(-0.3, 0.2, 1.0).normalized());
  std::vector<double> first;
  for (const FaceKernels* kernels : kernels_of_each_set()) {
    std::vector<double> out(3 * kCount), wide(4 * kCount);
    kernels->to_axes(world.data(), kCount, axes.to_world.data(), axes.origin.data(), out.data(), wide.data());
    if (first.empty()) first = out;
    EXPECT_EQ(out, first);
    for (int i = 0; i < kCount; ++i) {
      const Vec3 expected =
          axes.in_axes(Vec3(Eigen::Map<const Vec3>(&world[3 * static_cast<std::size_t>(i)])));
      for (int k = 0; k < 3; ++k) {
        const double x = out[static_cast<std::size_t>(3 * i + k)];
        EXPECT_NEAR(x, expected[k], 1e-15 * 4.0);
        EXPECT_EQ(wide[static_cast<std::size_t>(4 * i + k)], x);
      }
    }
  }
}

// of faces with areas of both signs, of one sign, and of a single face
TEST(FaceKernels, BoundsAndLeastAreaOfAChunk) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr int kVertices = 90;
  const std::vector<double> wide = random_numbers(4 * kVertices, 2);
  const auto x = [&](int vertex, int k) { return wide[static_cast<std::size_t>(4 * vertex + k)]; };
  const auto area = [&](const int* c) {
    return (x(c[1], 0) - x(c[0], 0)) * (x(c[2], 1) - x(c[0], 1)) -
           (x(c[1], 1) - x(c[0], 1)) * (x(c[2], 0) - x(c[0], 0));
  };
  std::mt19937 random(3);
  int positive = 0, negative = 0;
  for (const int count : {1, 7, 32})
    for (const int turn : {0, 1, -1}) {  // areas at random, all positive, all negative
      std::vector<int> corners;
      while (corners.size() < 3 * static_cast<std::size_t>(count)) {
        int c[3];
        for (int& corner : c) corner = static_cast<int>(random() % kVertices);
        if (turn * area(c) < 0.0) std::swap(c[1], c[2]);
        if (turn == 0 || turn * area(c) > 0.0) corners.insert(corners.end(), c, c + 3);
      }
      for (const double side : {1.0, -1.0}) {
        double least = kInfinity, low[3], high[3];
        for (int k = 0; k < 3; ++k) {
          low[k] = kInfinity;
          high[k] = -kInfinity;
          for (const int vertex : corners) {
            low[k] = std::min(low[k], x(vertex, k));
            high[k] = std::max(high[k], x(vertex, k));
          }
        }
        for (int f = 0; f < count; ++f)
          least = std::min(least, side * area(&corners[3 * static_cast<std::size_t>(f)]));
        ++(least > 0.0 ? positive : negative);
        for (const FaceKernels* kernels : kernels_of_each_set()) {
          double lane_low[4], lane_high[4];
          EXPECT_EQ(kernels->bound(wide.data(), corners.data(), count, side, lane_low, lane_high), least);
          for (int k = 0; k < 3; ++k) {
            EXPECT_EQ(lane_low[k], low[k]);
            EXPECT_EQ(lane_high[k], high[k]);
          }
        }
      }
    }
  EXPECT_GE(positive, 6);
  EXPECT_GE(negative, 6);
}
