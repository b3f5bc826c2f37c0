#include <gtest/gtest.h>

#include <cmath>

#include "loop/penetration.h"
#include "loop/penetration_warning.h"
#include "loop/small_scenes.h"
#include "loop/summary.h"
#include "palpate/core/error.h"
#include "palpate/core/log.h"
#include "palpate/loop/run.h"
#include "summary_rows.h"

/// Deepest overlap that a run reports, for a round tool of 15 mm in a block 20 mm high.
namespace {

using namespace palpate;

/// @param depth  depth of the tool at the first query, before anything has yielded
loop::PenetrationReport penetration_of(double depth, const std::string& method = "distance") {
  scene::Description d = small_scenes::pressed_block(depth);
  d.contacts[0].method = method;
  const auto world = loop::assemble(d);
  EXPECT_TRUE(loop::run(*world, {}).status.ok());
  const std::vector<loop::PenetrationReport> all = loop::penetration_reports(*world);
  EXPECT_EQ(all.size(), 1u);
  return all.at(0);
}

// The block yields from then on, and the overlap decreases.
TEST(Penetration, IsThatOfTheDeepestQuery) {
  const loop::PenetrationReport of_points = penetration_of(0.003);
  EXPECT_EQ(of_points.pair, "block - tool");
  EXPECT_NEAR(of_points.deepest_m, 0.003, 0.02 * 0.003);
  EXPECT_NEAR(of_points.half_width_m, 0.01, 1e-12);
  EXPECT_FALSE(of_points.too_deep());
  // the vertex nearest to the axis is offset by 1 mm and 2 mm
  EXPECT_NEAR(penetration_of(0.003, "analytic").deepest_m, 0.015 - std::hypot(0.001, 0.002, 0.012), 1e-9);
}

TEST(Penetration, IsNothingWithoutTouch) {
  EXPECT_EQ(penetration_of(-0.001).deepest_m, 0.0);
  EXPECT_FALSE(penetration_of(-0.001).too_deep());
}

TEST(Penetration, IsTooDeepBeyondHalfOfTheThinnerSide) {
  EXPECT_TRUE(penetration_of(0.0105).too_deep());
  EXPECT_FALSE(penetration_of(0.0095).too_deep());
}

TEST(Penetration, StandsInTheSummary) {
  const auto world = loop::assemble(small_scenes::pressed_block(0.003));
  const loop::RunResult result = loop::run(*world, {});
  store::Summary summary = loop::summarise(*world, result, 0.0);
  const store::SummaryFields& row = summary.list("contacts").at(0);
  using Names = std::vector<std::string>;
  EXPECT_EQ(std::get<Names>(*summary_rows::find(row, "between")), (Names{"block", "tool"}));
  ASSERT_NE(summary_rows::find(row, "deepest_overlap_m"), nullptr);
  EXPECT_EQ(std::get<double>(*summary_rows::find(row, "deepest_overlap_m")),
            loop::penetration_reports(*world).at(0).deepest_m);
}

/// Warnings of a run with the tool at that depth.
std::vector<std::string> warnings_at(double depth) {
  log::configure(true, false);
  scene::Description d = small_scenes::pressed_block(depth);
  d.contacts[0].method = "distance";
  const auto world = loop::assemble(d);
  loop::PenetrationWarning warning;
  loop::RunOptions options;
  options.observers = {&warning};
  EXPECT_TRUE(loop::run(*world, options).status.ok());
  return log::warnings();
}

TEST(PenetrationWarning, ObjectThatStartsInsideAnotherIsRejectedWithTheWayOut) {
  EXPECT_TRUE(warnings_at(0.0095).empty());
  try {
    warnings_at(0.0105);
    FAIL() << "accepted";
  } catch (const Error& error) {
    const std::string message = error.what();
    // a ball 10.5 mm deep in a flat face comes out by 10.5 mm along the normal of the face
    EXPECT_NE(
        message.find("\"tool\" starts 10.5 mm inside \"block\"; move \"tool\" by 10.5 mm along (0, 0, 1)"),
        std::string::npos)
        << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << "one line";
  }
}

TEST(PenetrationWarning, IsGivenOnceAndNamesContactTimeAndDepth) {
  log::configure(true, false);
  scene::Description d = small_scenes::pressed_block(0.0105);
  d.contacts[0].method = "distance";
  const auto world = loop::assemble(d);
  world->refresh_contact();
  loop::PenetrationWarning warning;
  warning.queried(*world, 0.25);
  warning.queried(*world, 0.5);
  const std::vector<std::string> given = log::warnings();
  ASSERT_EQ(given.size(), 1u);
  EXPECT_TRUE(given[0].starts_with("contact block - tool at t = 0.25 s: penetration reached 10."))
      << given[0];
  EXPECT_NE(given[0].find("half the thickness of the thinner side (20 mm)"), std::string::npos) << given[0];
}

}  // namespace
