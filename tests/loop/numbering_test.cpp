// Internally nodes are numbered in spatial order; output uses the numbers of the mesh file.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <random>

#include "loop/modes.h"
#include "loop/small_scenes.h"
#include "loop/trace.h"
#include "mesh/spatial_order.h"
#include "palpate/loop/recorder.h"
#include "palpate/loop/run.h"
#include "palpate/mesh/generators.h"
#include "palpate/store/run_file.h"
#include "store/mesh_file.h"
#include "temporary_folder.h"

using namespace palpate;

namespace {

/// Two blocks, the second from a file whose nodes are in random order; it swings.
class Numbering : public testing::Test {
 protected:
  Numbering() {
    file_ = mesh::box(Vec3(0.04, 0.04, 0.02), {5, 4, 3});
    std::vector<int> order(static_cast<std::size_t>(file_.nodes.cols()));
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), std::mt19937(11));
    mesh::renumber_nodes(file_, order);
    store::write_mesh((folder_ / "block.h5").string(), file_);

    scene_ = small_scenes::held_block();
    scene_.bodies.push_back(scene_.bodies[0]);
    SoftBodySpec& second = scene_.bodies[1];
    second.name = "second";
    second.mesh = {};
    second.mesh.file = (folder_ / "block.h5").string();
    second.position_m = shift_;
    scene_.gravity_m_s2 = Vec3(3.0, 1.0, -9.81);
    scene_.record.emplace();
    scene_.record->state_period_s = 0.02;
  }

  /// Checks part 1 of a run file against the state `q` of `world`.
  void expect_part(const store::RunReader& file, int step, const loop::World& world, const VecX& q) const {
    const dynamics::Block& block = *world.state.layout().find(world.bodies[1].block_id);
    const auto n = file_.nodes.cols();
    const Points points = file.points(step).middleCols(file.first_point(1), n);
    double moved = 0.0;
    for (Eigen::Index i = 0; i < n; ++i) {
      const int written = world.bodies[1].file_node[static_cast<std::size_t>(i)];
      EXPECT_EQ(Vec3(points.col(written)), Vec3(q.segment<3>(block.q_offset + 3 * i)));
      moved = std::max(moved, (points.col(written) - file_.nodes.col(written) - shift_).norm());
    }
    EXPECT_GT(moved, 1e-6);
    // each is near its position in the file: none is confused with another, 5 mm away
    EXPECT_LT(moved, 2e-3);
  }

  TemporaryFolder folder_;
  TetMesh file_;
  const Vec3 shift_{0.1, 0.0, 0.01};
  scene::Description scene_;
};

TEST_F(Numbering, ARunIsWrittenInTheOrderOfTheFile) {
  const auto world = loop::assemble(scene_);
  const loop::Body& body = world->bodies[1];
  EXPECT_NE(body.rest.tets, file_.tets);  // otherwise the test has no effect
  EXPECT_EQ(body.file_tets(), file_.tets);
  {
    loop::Recorder recorder(*world, folder_.string());
    loop::RunOptions options;
    options.observers = {&recorder};
    ASSERT_TRUE(loop::run(*world, options).status.ok());
  }

  const store::RunReader file((folder_ / "run.vtkhdf").string());
  EXPECT_EQ(file.parts()[1].tets, file_.tets);
  EXPECT_LT((file.parts()[1].reference - (file_.nodes.colwise() + shift_)).cwiseAbs().maxCoeff(), 1e-15);
  const int last = file.steps() - 1;
  expect_part(file, last, *world, world->state.q());
  const auto n = file_.nodes.cols();
  const dynamics::Block& block = *world->state.layout().find(body.block_id);
  const Points velocity = file.velocity(last).middleCols(file.first_point(1), n);
  const VecX written = file.stress(last).segment(file.first_point(1), n),
             stress = body.nodal_stress(world->state.view());
  for (Eigen::Index i = 0; i < n; ++i) {
    const int number = body.file_node[static_cast<std::size_t>(i)];
    EXPECT_EQ(Vec3(velocity.col(number)), Vec3(world->state.u().segment<3>(block.u_offset + 3 * i)));
    EXPECT_EQ(written[number], stress[i]);
  }
}

TEST_F(Numbering, ModesAreWrittenInTheOrderOfTheFile) {
  const auto world = loop::assemble(scene_);
  const modes::Modes modes = loop::find_modes(*world, 4);
  loop::write_modes(*world, modes, (folder_ / "modes.vtkhdf").string());
  const store::RunReader file((folder_ / "modes.vtkhdf").string());
  EXPECT_EQ(file.parts()[1].tets, file_.tets);
  EXPECT_LT((file.parts()[1].reference - (file_.nodes.colwise() + shift_)).cwiseAbs().maxCoeff(), 1e-15);
  const auto n = file_.nodes.cols();
  const loop::Body& body = world->bodies[1];
  for (int mode = 0; mode < 4; ++mode) {
    const Points shape = loop::displaced(*world, body, modes, mode),
                 written = file.points(mode).middleCols(file.first_point(1), n);
    const Points velocity = file.velocity(mode).middleCols(file.first_point(1), n),
                 rest = file_.nodes.colwise() + shift_;
    for (Eigen::Index i = 0; i < n; ++i)
      EXPECT_EQ(Vec3(written.col(body.file_node[static_cast<std::size_t>(i)])), Vec3(shape.col(i)));
    EXPECT_LT((velocity - modes.omega(mode) * (written - rest)).cwiseAbs().maxCoeff(),
              1e-12 * (1.0 + modes.omega(mode)));
  }
}

}  // namespace
