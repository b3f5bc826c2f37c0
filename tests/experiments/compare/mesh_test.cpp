// Error due to the mesh: levels, estimates, and scenes whose answer is known.
#include "experiments/compare/mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "experiments/compare/mesh_plan.h"
#include "experiments/compare/refined_meshes.h"
#include "experiments/compare/scenes.h"
#include "palpate/core/error.h"
#include "palpate/mesh/generators.h"
#include "report/table.h"
#include "store/mesh_file.h"
#include "store/model_file.h"
#include "temporary_folder.h"

using namespace palpate;
using compare::Convergence;
using compare::MeshComparison;
using compare::MeshVariable;
using compare::Status;

namespace {

MeshComparison compare_here(const scene::Description& d, const compare::MeshOptions& options) {
  experiments::EngineOutcome outcome;
  return compare::compare_mesh(d, options, {}, outcome);
}

const MeshVariable& variable_of(const MeshComparison& c, const char* name) {
  for (const MeshVariable& v : c.variables)
    if (v.name == name) return v;
  throw std::runtime_error(std::string("no resolution ") + name);
}

/// A slender bar under a small end load P, in equilibrium.  With nu = 0 its tip deflects by
/// P L^3/(3 E I) + P L/(kappa G A), kappa = 5/6 (Timoshenko 1921).
constexpr double kLength = 0.2, kHeight = 0.04, kYoung = 1e6, kLoad = 1e-3;
scene::Description bar(const std::string& mesh) {
  return loop::parse(R"([scene]
name = "bar"
duration_s = 0.01
[[body]]
name = "bar"
poissons_ratio = 0.0
youngs_modulus_pa = 1e6
)" + mesh + R"([[body.attachment]]
box_min_m = [-0.1001, -1.0, -1.0]
box_max_m = [-0.0999, 1.0, 1.0]
[[body.load]]
box_min_m = [0.0999, -1.0, -1.0]
box_max_m = [0.1001, 1.0, 1.0]
force_n = [0.0, 0.0, 1e-3]
[integrator]
name = "kinsol-static"
)",
                     "bar.toml");
}
const std::string kGenerated = R"([body.mesh]
generator = "box"
size_m = [0.2, 0.04, 0.04]
element_size_m = 0.0134
)";

double deflection() {
  const double inertia = std::pow(kHeight, 4) / 12.0, area = kHeight * kHeight;
  return kLoad * std::pow(kLength, 3) / (3.0 * kYoung * inertia) +
         kLoad * kLength / (5.0 / 6.0 * 0.5 * kYoung * area);
}

/// @param least_order  a file whose first division changes the shapes of its elements has a lower one
/// @param nearness  largest relative distance of the estimate: the bar is not slender, and its largest
///   displacement is not the mean of its end
void expect_contains_the_deflection(const MeshComparison& c, double least_order, double nearness) {
  const MeshVariable& elements = variable_of(c, compare::kElements);
  ASSERT_EQ(elements.levels.size(), 3u);
  for (const compare::MeshLevel& level : elements.levels)
    ASSERT_EQ(level.status, Status::kOk) << level.reason;
  EXPECT_EQ(elements.levels[1].elements, 8 * elements.levels[0].elements);
  EXPECT_NEAR(elements.levels[2].size, 0.25, 1e-9);
  const compare::MeshError& peak = elements.errors[0];
  EXPECT_EQ(peak.limit.kind, Convergence::kAsymptotic);
  EXPECT_GT(peak.limit.order, least_order);
  EXPECT_LT(peak.limit.order, 2.3);
  EXPECT_LE(std::abs(peak.limit.value - deflection()), peak.limit.uncertainty);
  EXPECT_LT(std::abs(peak.limit.value / deflection() - 1.0), nearness);
  EXPECT_GT(std::abs(elements.levels[0].values[0].value / deflection() - 1.0), 0.1);
  EXPECT_NEAR(peak.error, elements.levels[0].values[0].value - peak.limit.value, 1e-15);
}

compare::MeshOptions only(std::vector<std::string> variables) {
  compare::MeshOptions options;
  options.variables = std::move(variables);
  return options;
}

TEST(Mesh, TheEstimateContainsTimoshenkosDeflection) {
  expect_contains_the_deflection(compare_here(bar(kGenerated), only({compare::kElements})), 1.4, 0.02);
}

TEST(Mesh, TheEstimateOfADividedFileContainsTimoshenkosDeflection) {
  const TemporaryFolder folder;
  const std::string file = folder.string() + "/bar.h5";
  store::write_mesh(file, mesh::box({kLength, kHeight, kHeight}, {15, 3, 3}));
  compare::MeshOptions options = only({compare::kElements});
  options.folder = folder.string();
  expect_contains_the_deflection(
      compare_here(bar("mesh = { file = \"" + file + "\", scale = 1.0 }\n"), options), 0.8, 0.06);
}

/// A ball that stands on the middle triangle of a face and sags under its weight, in equilibrium. Its lowest
/// three nodes are glued; those around them slide in a cup.
std::string standing_ball(double lowest, const std::string& mesh) {
  return R"([scene]
name = "ball"
duration_s = 0.01
gravity_m_s2 = [0.0, 0.0, -9.81]
[[body]]
name = "ball"
rotation_vector_rad = [0.6755, -0.6755, 0.0]
youngs_modulus_pa = 1e6
poissons_ratio = 0.2
density_kg_m3 = 1000.0
)" + mesh +
         fmt::format(R"(
[[body.attachment]]
box_min_m = [-1, -1, -1]
box_max_m = [1, 1, {0}]
[[body.attachment]]
box_min_m = [-1, -1, {0}]
box_max_m = [1, 1, {1}]
axes = "xy"
[integrator]
name = "kinsol-static"
)",
                     lowest + 1e-6, lowest + 0.012);
}
const std::string kBall = "mesh = { generator = \"ball\", radius_m = 0.03, element_size_m = 0.0156 }";
double lowest_node() {
  const auto world = loop::assemble(loop::parse(standing_ball(0.0, kBall), "ball.toml"));
  return world->bodies[0].placed.row(2).minCoeff();
}

/// Number of edges of the only body whose ends are both held along an axis.
std::size_t held_edges(const loop::World& world, int axis) {
  const std::vector<int>& held = world.system.driven_dofs();
  const auto is_held = [&](int node) {
    return std::find(held.begin(), held.end(), 3 * node + axis) != held.end();
  };
  std::set<std::pair<int, int>> edges;
  const Tets& tets = world.bodies[0].rest.tets;
  for (Eigen::Index t = 0; t < tets.cols(); ++t)
    for (int i = 0; i < 4; ++i)
      for (int k = 0; k < 4; ++k)
        if (tets(i, t) < tets(k, t) && is_held(tets(i, t)) && is_held(tets(k, t)))
          edges.emplace(tets(i, t), tets(k, t));
  return edges.size();
}

// Nodes that a division adds are held where the edge that they halve did not move before, so that the held
// part of the body stays the same: a triangle remains one, and all below the border slides in the cup.
TEST(Mesh, AttachmentsHoldTheSamePartOfADividedBody) {
  const TemporaryFolder folder;
  compare::RefinedMeshes meshes(folder.string(), {});
  const scene::Description coarse = loop::parse(standing_ball(lowest_node(), kBall), "ball.toml");
  const auto held = [](const loop::World& world, int axis) {
    std::vector<Vec3> out;
    for (const int dof : world.system.driven_dofs())
      if (dof % 3 == axis) out.emplace_back(world.bodies[0].placed.col(dof / 3));
    return out;
  };
  const auto before = loop::assemble(coarse);
  ASSERT_EQ(held(*before, 2).size(), 3u);
  const std::size_t cup = held(*before, 0).size();
  ASSERT_GT(cup, 6u);
  for (int divisions = 1; divisions <= 2; ++divisions) {
    const std::vector<std::string> overrides =
        compare::mesh_overrides(coarse, compare::kElements, divisions, meshes);
    ASSERT_EQ(overrides.size(), 1u);
    const auto after =
        loop::assemble(loop::parse(standing_ball(lowest_node(), kBall), "ball.toml", overrides));
    EXPECT_EQ(after->bodies[0].report.elements, before->bodies[0].report.elements << (3 * divisions));
    // a triangle whose edges are halved d times has (2^d + 1)(2^d + 2)/2 nodes
    const std::vector<Vec3> glued = held(*after, 2);
    EXPECT_EQ(glued.size(), divisions == 1 ? 6u : 15u);
    for (const Vec3& x : glued) EXPECT_NEAR(x.z(), lowest_node(), 1e-6);
    // nodes are held in x where the nodes of the coarse mesh around them are: convex combinations of those
    double highest = -1.0;
    for (const Vec3& x : held(*before, 0)) highest = std::max(highest, x.z());
    for (const Vec3& x : held(*after, 0)) EXPECT_LE(x.z(), highest + 1e-12);
    if (divisions == 1) {
      EXPECT_EQ(held(*after, 0).size(), cup + held_edges(*before, 0)) << "one more per edge";
    }
  }
}

// The lowest third of a ball is held. Finer balls by the formula are rounder, and their borders of the held
// part lie elsewhere: their sags oscillate. Divided elements converge with the order 1 of a clamped edge.
TEST(Mesh, ABodyWithAttachmentsConvergesWithItsElements) {
  const TemporaryFolder folder;
  compare::MeshOptions options = only({compare::kElements});
  options.folder = folder.string();
  const std::string ball = "mesh = { generator = \"ball\", radius_m = 0.03, element_size_m = 0.0078 }";
  const scene::Description scene =
      loop::parse(standing_ball(-0.028, ball), "ball.toml",
                  {"body.0.attachment.1.axes=xyz", "body.0.attachment.1.box_max_m.2=-0.016"});
  const MeshComparison c = compare_here(scene, options);
  const MeshVariable& elements = variable_of(c, compare::kElements);
  ASSERT_EQ(elements.levels.size(), 3u);
  for (const compare::MeshLevel& level : elements.levels)
    ASSERT_EQ(level.status, Status::kOk) << level.reason;
  EXPECT_EQ(elements.levels[2].elements, 64 * elements.levels[0].elements);
  const compare::MeshError& peak = elements.errors[0];
  EXPECT_EQ(peak.limit.kind, Convergence::kAsymptotic);
  EXPECT_GT(peak.limit.order, 0.85);
  EXPECT_LT(peak.limit.order, 1.3);
  EXPECT_LT(peak.limit.uncertainty, 0.1 * peak.limit.value);
}

TEST(Mesh, AResolutionThatTheSceneLacksIsReported) {
  const MeshComparison c = compare_here(bar(kGenerated), only({compare::kPoints, compare::kTogether}));
  EXPECT_NE(variable_of(c, compare::kPoints).unchanged.find("no [[contact]]"), std::string::npos);
  EXPECT_NE(variable_of(c, compare::kTogether).unchanged.find("only resolution"), std::string::npos);
}

TEST(Mesh, LevelsThatAreEqualAreReported) {
  // A cell of 10 m stays one cell across each of three levels.
  std::string coarse = kGenerated;
  coarse.replace(coarse.find("0.0134\n"), 7, "10.0\n");
  const MeshComparison c = compare_here(bar(coarse), only({compare::kElements}));
  const MeshVariable& elements = variable_of(c, compare::kElements);
  EXPECT_EQ(elements.levels[2].elements, elements.levels[0].elements);
  EXPECT_EQ(elements.errors[0].limit.kind, Convergence::kEqual);
  const std::vector<std::string> words = compare::in_words(c);
  ASSERT_FALSE(words.empty());
  EXPECT_NE(words[0].find("no effect: the levels are equal"), std::string::npos) << words[0];
}

TEST(Mesh, ACoarserLevelIsBeforeTheScenes) {
  compare::MeshOptions options = only({compare::kElements});
  options.coarser = 1;
  const MeshComparison c = compare_here(bar(kGenerated), options);
  const MeshVariable& elements = variable_of(c, compare::kElements);
  EXPECT_EQ(elements.levels[0].divisions, -1);
  // Three cells of 13.4 mm across become one: the size is that of the mesh, not of the key.
  EXPECT_NEAR(elements.levels[0].size, std::cbrt(675.0 / static_cast<double>(elements.levels[0].elements)),
              1e-12);
  EXPECT_GT(elements.levels[0].size, 2.0);
  EXPECT_NEAR(elements.errors[0].error, elements.levels[1].values[0].value - elements.errors[0].limit.value,
              1e-15);
}

#ifdef PALPATE_HAS_TOOL
const std::string kHeld = R"([[device.keyframe]]
time_s = 0.01
position_m = [0.001, 0.002, 0.033]
[[device.keyframe]]
time_s = 0.04
position_m = [0.001, 0.002, 0.033]
)";

TEST(Mesh, AScriptHoldsWhereItRests) {
  const scene::Description d =
      loop::parse(compare_scenes::touch_text("0.035", "tick_s = 1e-3\n", "", kHeld), "touch.toml");
  EXPECT_NEAR(compare::end_of_hold(d, 0.04), 0.04, 1e-12);
  EXPECT_TRUE(std::isnan(compare::end_of_hold(d, 0.01)));
}

TEST(Mesh, EveryLevelOfATouchHasAForceWhoseTimeErrorIsKnown) {
  const scene::Description d =
      loop::parse(compare_scenes::touch_text("0.035", "tick_s = 1e-3\n", "", kHeld), "touch.toml");
  compare::MeshOptions options = only({compare::kElements, compare::kSkin, compare::kPoints});
  const MeshComparison c = compare_here(d, options);
  const MeshVariable& elements = variable_of(c, compare::kElements);
  ASSERT_EQ(elements.levels.size(), 3u);
  for (const compare::MeshLevel& level : elements.levels) {
    ASSERT_EQ(level.status, Status::kOk) << level.reason;
    EXPECT_GT(level.values[0].value, 0.1);
    EXPECT_GT(level.values[0].time_error, 0.0);
    EXPECT_LE(level.values[1].value, level.values[0].value * (1.0 + 1e-12));
    EXPECT_GT(level.cpu_s, 0.0);
  }
  EXPECT_TRUE(std::isnan(elements.levels[2].from_finest));
  EXPECT_GT(elements.levels[0].from_finest, elements.levels[1].from_finest);
  // A finer mesh is softer.
  EXPECT_GT(elements.levels[0].values[1].value, elements.levels[2].values[1].value);
  EXPECT_GT(elements.errors[1].error, 0.0);
  EXPECT_FALSE(variable_of(c, compare::kSkin).unchanged.empty());
  const MeshVariable& points = variable_of(c, compare::kPoints);
  ASSERT_EQ(points.levels.size(), 3u);
  EXPECT_GT(points.levels[2].most_samples, points.levels[0].most_samples);
  EXPECT_LT(std::abs(points.errors[1].error), std::abs(elements.errors[1].error));
}

TEST(Mesh, TheTableHasOneRowPerLevel) {
  const scene::Description d =
      loop::parse(compare_scenes::touch_text("0.035", "tick_s = 1e-3\n", "", kHeld), "touch.toml");
  const TemporaryFolder folder;
  const MeshComparison c = compare::mesh_error(d, folder.string(), {}, {});
  ASSERT_EQ(c.variables.size(), 1u);
  EXPECT_EQ(c.variables[0].errors[0].limit.kind, Convergence::kTwoLevels);
  compare::write(c, folder.string());
  const report::Table table = report::read_csv(folder.string() + "/mesh.csv");
  EXPECT_EQ(table.rows.size(), 2u);
  EXPECT_NEAR(table.numbers("peak_n")[0], c.variables[0].levels[0].values[0].value, 1e-12);
  const std::vector<std::string> words = compare::in_words(c);
  ASSERT_GE(words.size(), 2u);
  EXPECT_NE(words[0].find("peak force"), std::string::npos) << words[0];
  EXPECT_NE(words[0].find("two levels"), std::string::npos) << words[0];
}
#endif

TEST(Mesh, ASceneWithoutBodiesIsRejected) {
  try {
    compare_here(compare_scenes::tool_only(), {});
    FAIL();
  } catch (const Error& e) { EXPECT_NE(std::string(e.what()).find("no [[body]]"), std::string::npos); }
}

}  // namespace
