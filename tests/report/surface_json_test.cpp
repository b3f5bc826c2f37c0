#include "report/surface_json.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "core/object_colours.h"
#include "palpate/mesh/boundary.h"
#include "palpate/mesh/generators.h"
#include "palpate/store/run_file.h"
#include "report/decimate.h"
#include "temporary_folder.h"

using namespace palpate;
using nlohmann::json;

namespace {

std::vector<int> numbers_of(const std::string& text) {
  static const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned group = 0;
  int bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    group = group << 6 | static_cast<unsigned>(digits.find(c));
    if ((bits += 6) < 8) continue;
    bits -= 8;
    bytes += static_cast<char>(group >> bits & 0xFF);
  }
  std::vector<int> out;
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2)
    out.push_back(static_cast<unsigned char>(bytes[i]) | static_cast<unsigned char>(bytes[i + 1]) << 8);
  return out;
}

/// A ball that moves to +x by 1 mm per step, and a tool of one triangle at rest.
constexpr int kSteps = 5;
std::filesystem::path moving_ball(const TemporaryFolder& folder, const TetMesh& ball) {
  Points triangle(3, 3);
  triangle << 0, 1, 0, 0, 0, 1, 0.5, 0.5, 0.5;
  Faces face(3, 1);
  face << 0, 1, 2;
  const auto path = folder / "run.vtkhdf";
  store::RunFile file(path.string(), {{"ball", ball.nodes, ball.tets, {}}, {"tool", triangle, {}, face}},
                      {"s", "", "", kSteps});
  for (int s = 0; s < kSteps; ++s) {
    Points points(3, ball.nodes.cols() + 3);
    points << ball.nodes, triangle;
    points.row(0).head(ball.nodes.cols()).array() += 1e-3 * s;
    file.append(0.01 * s, points, Points::Zero(3, points.cols()), VecX::Zero(points.cols()));
  }
  file.close();
  return path;
}

}  // namespace

TEST(SurfaceJson, HoldsTheBoundaryAtItsPositionsWithinTheQuantisation) {
  const TemporaryFolder folder;
  const TetMesh ball = mesh::ball(0.05, 0.02);
  const mesh::Boundary outer = mesh::boundary(ball);
  const store::RunReader run(moving_ball(folder, ball).string());
  const json view = json::parse(report::surface_json(run));
  ASSERT_EQ(view["times_s"].size(), kSteps);
  ASSERT_EQ(view["parts"].size(), 2u);
  const json& body = view["parts"][0];
  EXPECT_EQ(body["kind"], "body");
  EXPECT_EQ(view["parts"][1]["kind"], "tool");
  EXPECT_NEAR(view["most_displacement_m"], 4e-3, 1e-12);
  EXPECT_EQ(view["first_shown"], kSteps - 1);
  EXPECT_EQ(json::parse(report::surface_json(run, {}, {.shown_at_s = 0.011}))["first_shown"], 2)
      << "the state that follows";
  EXPECT_EQ(json::parse(report::surface_json(run, {}, {.shown_at_s = 0.01 * (1.0 + 1e-12)}))["first_shown"],
            1);
  EXPECT_EQ(json::parse(report::surface_json(run, {}, {.shown_at_s = 9.0}))["first_shown"], kSteps - 1)
      << "the last";
  const auto vertices = static_cast<std::size_t>(outer.surface.vertices.cols());
  ASSERT_EQ(body["vertices"], vertices) << "nothing inside the ball";
  const std::vector<int> positions = numbers_of(body["positions"]), faces = numbers_of(body["faces"]);
  ASSERT_EQ(positions.size(), kSteps * 3 * vertices);
  ASSERT_EQ(faces.size(), static_cast<std::size_t>(outer.surface.faces.size()));
  for (int s = 0; s < kSteps; ++s)
    for (std::size_t v = 0; v < vertices; ++v)
      for (std::size_t k = 0; k < 3; ++k) {
        const double low = view["low_m"][k], high = view["high_m"][k], step = (high - low) / 65535.0;
        const double at = low + step * positions[(static_cast<std::size_t>(s) * vertices + v) * 3 + k];
        const double exact =
            outer.surface.vertices(static_cast<int>(k), static_cast<int>(v)) + (k == 0 ? 1e-3 * s : 0.0);
        ASSERT_NEAR(at, exact, 0.51 * step) << "step " << s << ", vertex " << v << ", axis " << k;
      }
}

TEST(SurfaceJson, AFreeBodyThatOnlyMovesHasNoDisplacement) {
  const TemporaryFolder folder;
  const store::RunReader run(moving_ball(folder, mesh::ball(0.05, 0.02)).string());
  const json view = json::parse(report::surface_json(run, {}, {.free_bodies = {"ball"}}));
  EXPECT_NEAR(view["most_displacement_m"], 0.0, 1e-12);
  const json& motions = view["parts"][0]["motions"];
  ASSERT_EQ(motions.size(), kSteps);
  for (int s = 0; s < kSteps; ++s)
    for (int i = 0; i < 12; ++i) {
      const double expected = i == 0 || i == 4 || i == 8 ? 1.0 : i == 9 ? 1e-3 * s : 0.0;
      EXPECT_NEAR(motions[s][i], expected, 1e-10) << "step " << s << ", entry " << i;
    }
  EXPECT_FALSE(view["parts"][1].contains("motions"));
}

TEST(SurfaceJson, HasTheColoursAndTheViewOfThePictures) {
  const TemporaryFolder folder;
  const store::RunReader run(moving_ball(folder, mesh::ball(0.05, 0.03)).string());
  const json view = json::parse(report::surface_json(
      run, {}, {.tools = {"other", "tool"}, .from = {1, 0, 0}, .target_m = {{0, 0, 1}}, .zoom = 2.0}));
  EXPECT_EQ(view["ramp"].size(), colours::kRamp.size());
  EXPECT_EQ(view["parts"][0]["colour"], colours::kBody);
  EXPECT_EQ(view["parts"][1]["colour"], colours::kTools[1]);
  EXPECT_EQ(view["from"], json({1.0, 0.0, 0.0}));
  EXPECT_EQ(view["target_m"], json({0.0, 0.0, 1.0}));
  EXPECT_EQ(view["zoom"], 2.0);
  const json bone = json::parse(report::surface_json(run, {}, {.tools = {"other"}}));
  EXPECT_EQ(bone["parts"][1]["colour"], colours::kBone);
}

TEST(SurfaceJson, KeepsItsBudgetInSpaceAndTime) {
  const TemporaryFolder folder;
  const TetMesh ball = mesh::ball(0.05, 0.006);
  ASSERT_GT(mesh::boundary(ball).surface.vertices.cols(), 600);
  const store::RunReader run(moving_ball(folder, ball).string());
  const std::string text = report::surface_json(run, {300, 6 * 300 * 3, 240});
  const json view = json::parse(text);
  const std::size_t vertices = view["parts"][0]["vertices"];
  EXPECT_LE(vertices, 300u);
  EXPECT_GT(vertices, 20u);
  EXPECT_GE(view["times_s"].size(), 3u);
  EXPECT_LT(view["times_s"].size(), static_cast<std::size_t>(kSteps) + 1);
  EXPECT_EQ(view["times_s"].front(), 0.0);
  EXPECT_NEAR(view["times_s"].back(), 0.04, 1e-12) << "the end of the run is shown";
}

TEST(SurfaceJson, IsEmptyForARunWithoutASteps) {
  const TemporaryFolder folder;
  const auto path = (folder / "none.vtkhdf").string();
  const TetMesh ball = mesh::ball(0.05, 0.03);
  store::RunFile(path, {{"ball", ball.nodes, ball.tets, {}}}, {"s", "", "", 3}).close();
  EXPECT_EQ(report::surface_json(store::RunReader(path)), "");
}

// A decimated body keeps its shape: closed, of the same size, and with a subset of the vertices.
TEST(Decimate, KeepsTheShapeWithFewerVertices) {
  const TriMesh fine = mesh::boundary(mesh::ball(0.05, 0.004)).surface;
  const report::CoarseSurface coarse = report::decimate(fine.vertices, fine.faces, 400);
  ASSERT_LE(coarse.kept.size(), 400u);
  ASSERT_GT(coarse.kept.size(), 150u) << "the budget is used";
  EXPECT_EQ(std::set<int>(coarse.kept.begin(), coarse.kept.end()).size(), coarse.kept.size());
  Points vertices(3, static_cast<Eigen::Index>(coarse.kept.size()));
  for (std::size_t i = 0; i < coarse.kept.size(); ++i)
    vertices.col(static_cast<Eigen::Index>(i)) = fine.vertices.col(coarse.kept[i]);
  EXPECT_EQ(coarse.faces.minCoeff(), 0);
  EXPECT_LT(coarse.faces.maxCoeff(), static_cast<int>(coarse.kept.size()));
  const double exact = mesh::enclosed_volume(fine);
  EXPECT_NEAR(mesh::enclosed_volume({vertices, coarse.faces}), exact, 0.05 * exact);
}

TEST(Decimate, LeavesASmallSurfaceAlone) {
  const TriMesh surface = mesh::boundary(mesh::ball(0.05, 0.03)).surface;
  const report::CoarseSurface same = report::decimate(surface.vertices, surface.faces, 100'000);
  EXPECT_EQ(same.kept.size(), static_cast<std::size_t>(surface.vertices.cols()));
  EXPECT_EQ(same.faces, surface.faces);
}
