#include "model/make_model.h"

#include <gtest/gtest.h>

#include "palpate/mesh/embedding.h"
#include "surfaces.h"

using namespace palpate;
using namespace surfaces;

namespace {

model::Input input(const TriMesh& surface) {
  model::Input out;
  out.name = "test";
  out.source = "test.obj";
  out.from = from();
  out.surface = surface;
  return out;
}

model::Options small() {
  model::Options out;
  out.tetrahedra.tetrahedra = 1000;
  out.proxies = 12;
  return out;
}

model::Made made(model::Input from, const model::Options& options = small()) {
  model::ProgressListener silent;
  return model::make_model(std::move(from), options, silent);
}

TEST(MakeModel, HasEveryLevel) {
  model::Input from = input(ball(1.0, 10));
  from.skin = ball(1.02, 20);
  from.skeleton.bones = {{"root", -1, {0, 0, -0.5}, {0, 0, 0}, 0.3, 0.3},
                         {"tip", 0, {0, 0, 0}, {0, 0, 0.5}, 0.3, 0.2}};
  const model::Made result = made(std::move(from));
  const LayeredModel& m = result.file.model;
  EXPECT_NEAR(static_cast<double>(m.tets.tets.cols()), 1000, 30);
  EXPECT_EQ(m.skin.vertices, ball(1.02, 20).vertices);
  Points again;
  mesh::evaluate(m.embedding, m.tets.tets, m.tets.nodes, again);
  EXPECT_LT((again - m.skin.vertices).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_GE(m.proxies.size(), 2u);
  std::vector<char> held(static_cast<std::size_t>(m.skin.vertices.cols()), 0);
  for (const ProxyHull& proxy : m.proxies) {
    EXPECT_LE(proxy.corners.cols(), 32);
    for (const int v : proxy.members) held[static_cast<std::size_t>(v)] = 1;
  }
  EXPECT_EQ(std::count(held.begin(), held.end(), 0), 0);
  EXPECT_GT(std::count(m.bone_of_node.begin(), m.bone_of_node.end(), 0), 0);
  EXPECT_GT(std::count(m.bone_of_node.begin(), m.bone_of_node.end(), 1), 0);
  EXPECT_EQ(result.steps.size(), 6u);
}

TEST(MakeModel, TakesTetrahedraAsTheyAre) {
  model::Input from;
  from.source = "ball.msh";
  from.from.source = "ball.msh";
  from.tets = mesh::ball(1.0, 0.3);
  const model::Made taken = made(from);
  EXPECT_EQ(taken.file.model.tets.tets, from.tets.tets);
  model::Options options = small();
  options.remesh = true;
  EXPECT_NEAR(static_cast<double>(made(from, options).file.model.tets.tets.cols()), 1000, 30);
}

TEST(MakeModel, RefusesBadTetrahedraOfAPerson) {
  model::Input from;
  from.source = from.from.source = "flat.msh";
  from.tets = mesh::ball(1.0, 0.3);
  from.tets.nodes.row(2) *= 0.05;
  EXPECT_NE(refusal([&] { made(from); }).find("dihedral angle"), std::string::npos);
}

TEST(MakeModel, CreasesLowerTheGateAndAreNoted) {
  const model::Made result = made(input(box()));
  EXPECT_TRUE(result.creased);
  ASSERT_EQ(result.file.record.notes.size(), 1u);
  EXPECT_EQ(result.file.record.notes[0], "edges that turn by more than 50 degrees are kept as creases");
  EXPECT_LE(result.quality.volume_error, 1e-9);
}

TEST(MakeModel, ScalesEverything) {
  model::Options options = small();
  options.scale = 0.001;
  const model::Made result = made(input(ball()), options);
  EXPECT_NEAR(result.quality.volume, 1e-9 * volume(ball()), 1e-13);
  EXPECT_NEAR(result.file.model.skin.vertices.cwiseAbs().maxCoeff(), 0.001, 1e-9);
}

TEST(MakeModel, NoProxiesWhereNoneAreWanted) {
  model::Options options = small();
  options.proxies = 0;
  EXPECT_TRUE(made(input(ball()), options).file.model.proxies.empty());
}

}  // namespace
