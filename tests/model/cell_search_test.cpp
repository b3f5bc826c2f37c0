// Search for the cell size, with a mesher that follows a formula: number of rounds, and reported progress.
#include "model/cell_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "palpate/core/error.h"

using namespace palpate;

namespace {

/// Mesher that makes 5 V / c^3 tetrahedra of a unit volume, of which optimisation keeps a different fraction
/// each time, never the one measured before.
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

// Three rounds, the last of which keeps nothing, so that the search fails: the progress bar advances through
// all of them, with room for each.
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

namespace {

/// Fails in its first `left_to_fail` optimisations.
struct FailingMesher final : model::CellMesher {
  int refined = 0, left_to_fail = 0, optimised = 0, found = 0;
  std::optional<Vec3> crossing(const Vec3&, const Vec3&) const override { return std::nullopt; }
  model::CellCount refine(double cell, double, const model::Progress&) override {
    ++refined;
    found = static_cast<int>(std::lround(5.0 / (cell * cell * cell)));
    return {found, found / 4, 1.3 * cell};
  }
  void optimise(const model::Progress&) override {
    if (left_to_fail-- > 0) throw model::OptimisationFailed{};
    ++optimised;
  }
  model::FittedMesh take() override { return {}; }
  std::vector<std::string> notes() const override { return {"without a stage", "without another"}; }
};

}  // namespace

TEST(CellSearch, AMeshWhoseOptimisationFailedIsMadeAgain) {
  model::TetrahedraOptions options;
  options.tetrahedra = 1000;
  int failures_seen = 0;
  for (const int failures : {0, 1, 2}) {
    FailingMesher sound, mesher;
    mesher.left_to_fail = failures;
    EXPECT_THROW(model::search_cells(sound, 1.0, false, options, {}), Error) << "it makes no tetrahedra";
    EXPECT_THROW(model::search_cells(mesher, 1.0, false, options, {}), Error);
    EXPECT_EQ(mesher.refined, sound.refined + failures);
    EXPECT_EQ(mesher.optimised, sound.optimised);
    failures_seen += failures;
  }
  EXPECT_EQ(failures_seen, 3);
}

namespace {

/// A sheet: its boundary needs more tetrahedra with cells larger than its thickness, not fewer.
struct SheetMesher final : model::CellMesher {
  int refined = 0;
  std::optional<Vec3> crossing(const Vec3&, const Vec3&) const override { return std::nullopt; }
  model::CellCount refine(double cell, double, const model::Progress&) override {
    ++refined;
    const double thickness = 0.1,
                 found = 5.0 / std::pow(std::min(cell, thickness), 3) * std::max(cell / thickness, 1.0);
    return {static_cast<int>(found), static_cast<int>(found / 4), 1.3 * cell};
  }
  void optimise(const model::Progress&) override {}
  model::FittedMesh take() override { return {}; }
  double thickness() const override { return 0.1; }
};

std::string refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& e) { return e.what(); }
  return "nothing was refused";
}

}  // namespace

TEST(CellSearch, ASheetIsRefusedAtTheSecondAttemptWithTheNumberThatItTakes) {
  model::TetrahedraOptions options;
  options.tetrahedra = 2000;
  SheetMesher mesher;
  const std::string said = refusal([&] { model::search_cells(mesher, 1.0, false, options, {}); });
  EXPECT_EQ(mesher.refined, 2);
  // 5 V / t^3 = 5000, times the first cell over the thickness, (5 * 0.957 / 2000)^(1/3) / 0.1 = 1.34
  EXPECT_NE(said.find("no mesh of 2000 tetrahedra within 3 % was found, the nearest has 6"),
            std::string::npos)
      << said;
  EXPECT_NE(said.find("or more, drop creases"), std::string::npos) << said;
}

TEST(CellSearch, ASheetFarTooThinIsRefusedBeforeTheFirstMesh) {
  const model::BodySize size{0.01, 2.0};  // 1 m by 1 m by 1 cm: 5 V / t^3 = 50,000
  model::TetrahedraOptions options;
  options.tetrahedra = 12'000;
  EXPECT_NE(refusal([&] { model::refuse_too_thin(size, Vec3::Zero(), options); })
                .find("about 0.01 m thick, with a surface of 2 m^2, at (0, 0, 0) m and elsewhere: it needs "
                      "about 5e+04 tetrahedra"),
            std::string::npos);
  options.tetrahedra = 13'000;
  EXPECT_EQ(refusal([&] { model::refuse_too_thin(size, Vec3::Zero(), options); }), "nothing was refused");
}
