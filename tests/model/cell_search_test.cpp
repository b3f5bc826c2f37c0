// The search for cells of the right size, with a mesher that obeys a formula: how often it goes round, and
// what it tells of it.
#include "model/cell_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "palpate/core/error.h"

using namespace palpate;

namespace {

/// 5 V / c^3 tetrahedra of a unit volume, of which optimising leaves another share each time, never the one
/// that was measured the time before.
struct FickleMesher final : model::CellMesher {
  std::vector<double> shares;
  int found = 0, taken = 0;

  explicit FickleMesher(std::vector<double> left) : shares(std::move(left)) {}
  std::optional<Vec3> crossing(const Vec3&, const Vec3&) const override { return std::nullopt; }
  model::CellCount refine(double cell, double, const model::Progress&) override {
    found = static_cast<int>(std::lround(5.0 / (cell * cell * cell)));
    return {found, found / 4, 1.3 * cell};
  }
  void optimise(const model::Progress& progress) override {
    for (const double fraction : {0.0, 0.3, 0.7, 1.0}) progress(fraction);
  }
  model::FittedMesh take() override {
    model::FittedMesh out;
    out.mesh.nodes = Points::Random(3, 4);
    out.mesh.tets.resize(4, std::lround(shares.at(static_cast<std::size_t>(taken++)) * found));
    out.mesh.tets.colwise() = Eigen::Vector4i(0, 1, 2, 3);
    return out;
  }
};

}  // namespace

// Three rounds, the last of which leaves nothing, so that the search gives up: the bar has gone on through
// all of them, and each had room.
TEST(CellSearch, TheBarNeverRunsBackOverSeveralRounds) {
  model::TetrahedraOptions options;
  options.tetrahedra = 1000;
  FickleMesher mesher({0.7, 0.5, 0.0});
  std::vector<double> told;
  EXPECT_THROW(
      model::search_cells(mesher, 1.0, false, options, [&](double fraction) { told.push_back(fraction); }),
      Error);
  EXPECT_EQ(mesher.taken, 3);
  EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
  EXPECT_GE(told.front(), 0.0);
  EXPECT_LE(told.back(), 1.0);
  for (const auto& [low, high] : {std::pair(0.0, 0.9), std::pair(0.9, 0.99), std::pair(0.99, 0.999)})
    EXPECT_GT(std::count_if(told.begin(), told.end(), [&](double x) { return x > low && x <= high + 1e-12; }),
              4)
        << low;
}
