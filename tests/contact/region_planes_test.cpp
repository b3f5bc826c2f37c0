#include "contact/region_planes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "palpate/core/pose.h"

using namespace palpate;
using contact::PairOverlap;
using contact::PlaneUnit;
using contact::RegionPlanes;

namespace {

/// In the plane of x and z, tilted from z.
Vec3 tilted(double angle) { return {std::sin(angle), 0.0, std::cos(angle)}; }

PairOverlap overlap(int a, int b, double volume, const Vec3& direction) {
  return {a, b, volume * direction, volume};
}

/// Proxies are in a row, on either side.
bool in_a_row(int p, int q) { return std::abs(p - q) <= 1; }

std::vector<PlaneUnit> planes(const std::vector<PairOverlap>& overlaps) {
  RegionPlanes planes;
  const auto found = planes.find(overlaps, in_a_row, in_a_row);
  return {found.begin(), found.end()};
}

Vec3 force(const std::vector<PairOverlap>& overlaps) {
  Vec3 sum = Vec3::Zero();
  for (const PlaneUnit& unit : planes(overlaps)) sum += unit.volume * unit.normal;
  return sum;
}

constexpr double kDegree = M_PI / 180.0;

/// Largest change of the force over so many steps from 0 to 1.
double largest_change(const std::function<std::vector<PairOverlap>(double)>& at, int steps) {
  double most = 0.0;
  Vec3 before = force(at(0.0));
  for (int i = 1; i <= steps; ++i) {
    const Vec3 now = force(at(static_cast<double>(i) / steps));
    most = std::max(most, (now - before).norm());
    before = now;
  }
  return most;
}

}  // namespace

TEST(RegionPlanes, PartsThatPushAboutTheSameWayShareTheirMean) {
  const std::vector<PairOverlap> parts{overlap(0, 0, 3.0, tilted(-20 * kDegree)),
                                       overlap(1, 0, 2.0, tilted(25 * kDegree))};
  const auto found = planes(parts);
  ASSERT_EQ(found.size(), 2u);
  const Vec3 mean = (parts[0].push + parts[1].push).normalized();
  for (const PlaneUnit& unit : found) EXPECT_NEAR((unit.normal - mean).norm(), 0.0, 1e-15);
}

TEST(RegionPlanes, WallsAtARightAngleKeepTheirOwn) {
  for (const auto& unit : planes({overlap(0, 0, 3.0, tilted(0)), overlap(1, 1, 2.0, tilted(90 * kDegree))}))
    EXPECT_NEAR((unit.normal - tilted(unit.proxy * 90 * kDegree)).norm(), 0.0, 1e-15);
}

TEST(RegionPlanes, AProxyIsOnePartWhateverItMeets) {
  const auto found = planes({overlap(4, 0, 3.0, tilted(0)), overlap(4, 1, 1.0, tilted(60 * kDegree))});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].proxy, 4);
  EXPECT_EQ(found[0].volume, 4.0);
  EXPECT_NEAR((found[0].normal - (3.0 * tilted(0) + tilted(60 * kDegree)).normalized()).norm(), 0.0, 1e-15);
}

TEST(RegionPlanes, ContactsInDifferentPlacesShareNoNormal) {
  for (const int b : {0, 7})  // apart on a alone; on both
    for (const auto& unit : planes({overlap(0, 0, 1.0, tilted(0)), overlap(3, b, 1.0, tilted(0.3))}))
      EXPECT_NEAR((unit.normal - tilted(0.1 * unit.proxy)).norm(), 0.0, 1e-15);
  // neighbours on a, but they meet different parts of b
  for (const auto& unit : planes({overlap(0, 0, 1.0, tilted(0)), overlap(1, 5, 1.0, tilted(0.3))}))
    EXPECT_NEAR((unit.normal - tilted(0.3 * unit.proxy)).norm(), 0.0, 1e-15);
}

TEST(RegionPlanes, ABridgeJoinsAsItGrows) {
  const auto bridged = [](double volume) {
    return std::vector<PairOverlap>{overlap(0, 0, 1.0, tilted(0)), overlap(1, 1, volume, tilted(0.3)),
                                    overlap(2, 2, 1.0, tilted(0.6))};
  };
  const Vec3 apart = planes(bridged(1e-9)).front().normal, joined = planes(bridged(0.3)).front().normal;
  EXPECT_NEAR((apart - tilted(0)).norm(), 0.0, 1e-6);
  EXPECT_NEAR((joined - tilted(0.3)).norm(), 0.0, 1e-12);
  const auto growing = [&](double s) { return bridged(0.3 * s + 1e-12); };
  const double coarse = largest_change(growing, 500), fine = largest_change(growing, 4000);
  EXPECT_LT(fine, 0.15 * coarse);
}

// the angle between two parts goes through all that merging and splitting is
TEST(RegionPlanes, MergingAndSplittingDoNotJump) {
  for (const double share : {1.0, 0.1, 1e-3}) {
    const auto opening = [&](double s) {
      return std::vector<PairOverlap>{overlap(0, 0, 1.0, tilted(0)), overlap(1, 0, share, tilted(3.0 * s))};
    };
    const double coarse = largest_change(opening, 1000), fine = largest_change(opening, 8000);
    EXPECT_GT(coarse, 0.0);
    EXPECT_LT(fine, 0.15 * coarse) << share;  // an eighth of it, where nothing jumps
    EXPECT_LT(coarse, 0.05 * (1.0 + share)) << share;
  }
}

// six parts in a row, each comes and goes and turns; what a jump is, a step of an eighth shows
TEST(RegionPlanes, RandomPathsDoNotJump) {
  std::mt19937 random(7);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
  double worst = 0.0;
  for (int path = 0; path < 40; ++path) {
    std::vector<double> phase;
    for (int i = 0; i < 24; ++i) phase.push_back(2.0 * M_PI * uniform());
    const auto at = [&](double s) {
      std::vector<PairOverlap> parts;
      for (int i = 0; i < 6; ++i) {
        const auto wave = [&](int k) {
          return std::sin(phase[static_cast<std::size_t>(4 * i + k)] + (2 + k) * s);
        };
        const double depth = std::max(0.0, 0.3 + wave(0));
        if (depth == 0.0) continue;
        const Vec3 direction = quaternion_of(1.2 * Vec3(wave(1), wave(2), wave(3))) * Vec3::UnitZ();
        parts.push_back(overlap(i, i / 2, depth * depth, direction));
      }
      return parts;
    };
    const double coarse = largest_change(at, 250), fine = largest_change(at, 2000);
    EXPECT_LT(fine, 0.2 * coarse) << path;
    worst = std::max(worst, fine);
  }
  EXPECT_GT(worst, 0.0);
}

TEST(RegionPlanes, TheyTurnWithTheBodiesAndKnowNoOrderOfB) {
  std::vector<PairOverlap> parts{overlap(0, 0, 1.0, tilted(0)), overlap(1, 0, 0.4, tilted(1.2)),
                                 overlap(1, 1, 0.3, tilted(0.9)), overlap(2, 1, 0.01, tilted(-0.7))};
  const auto found = planes(parts);
  const Quat turn = quaternion_of(Vec3(0.4, -1.1, 0.8));
  std::swap(parts[1], parts[2]);
  for (PairOverlap& part : parts) part.push = turn * part.push;
  const auto turned = planes(parts);
  ASSERT_EQ(turned.size(), found.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_NEAR((turned[i].normal - turn * found[i].normal).norm(), 0.0, 1e-14);
}
