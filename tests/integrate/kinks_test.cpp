// Embedded pairs whose error estimate misses a kink of the force (derivation in d_dropped_ball.cpp).
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "integrate/sundials/butcher_table.h"

namespace palpate {
namespace {

/// Fraction of positions theta within a step at which the error of y'' = (t - theta h)+ exceeds 860 times its
/// estimate.
double blind_part(const integrate::ButcherTable& table) {
  constexpr int kPlaces = 10000;
  const VecX c = table.A.rowwise().sum(), difference = table.b - table.embedded;
  int blind = 0;
  for (int i = 1; i < kPlaces; ++i) {
    const double theta = static_cast<double>(i) / kPlaces;
    const VecX force = (c.array() - theta).max(0.0);
    const double error = table.b.dot(force) - (1.0 - theta) * (1.0 - theta) / 2.0;
    blind += std::abs(error) > 860.0 * std::abs(difference.dot(force));
  }
  return static_cast<double>(blind) / kPlaces;
}

TEST(Kinks, ThreePairsOfOrderFourAndFiveAreBlindToThem) {
  std::set<std::string> blind;
  int seen = 0;
  for (const auto& method : integrate::ark_methods()) {
    if (!method.name.starts_with("ark-dirk-") || method.traits.order < 4) continue;
    ++seen;
    const double part = blind_part(integrate::leading_table(method));
    EXPECT_TRUE(part < 0.005 || part > 0.08) << method.name << ": " << part;
    if (part > 0.08) blind.insert(std::string(method.name));
  }
  EXPECT_GE(seen, 14);
  EXPECT_EQ(blind, (std::set<std::string>{"ark-dirk-sdirk534", "ark-dirk-ark548b", "ark-dirk-ark437"}));
}

}  // namespace
}  // namespace palpate
