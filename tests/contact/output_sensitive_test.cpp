// The cost of a query of skins with proxies depends on the skin that may collide, not on the whole skin.
#include "contact/image_side.h"
#include "contact/image_source.h"
#include "proxy/pruner.h"
#include "touching.h"

using namespace contact_tests;

namespace {

struct Work {
  long vertices, evaluated, faces, handed_on;
};

/// Two queries of a ball with `rings` rings under a small rigid ball that touches its top.
Work work(int rings, int cells) {
  const TetMesh ball = mesh::ball(1.0, 0.45);
  const TriMesh skin = mesh::sphere(1.0, rings), rigid = sphere(Vec3(0.05, 0.02, 1.13), 0.15, 24);
  dynamics::State state;
  dynamics::BlockSpec nodes;
  nodes.name = "ball";
  nodes.q_size = nodes.u_size = static_cast<int>(ball.nodes.size());
  contact::NodeSurface surface;
  surface.block_id = state.insert(nodes, Eigen::Map<const VecX>(ball.nodes.data(), ball.nodes.size()),
                                  VecX::Zero(nodes.u_size));
  surface.faces = skin.faces;
  surface.embedding = mesh::embed(ball, skin.vertices);
  surface.tets = ball.tets;
  const auto proxies = proxies_of(ball, skin, surface.embedding, cells);
  const std::shared_ptr<contact::ImageSide> soft = contact::soft_side(surface),
                                            other = contact::rigid_side(rigid, 0, contact::fixed_frame());
  const auto source =
      contact::make_pruned_source(soft, proxies, other, proxies_of(rigid), image_options(64, 0.01));
  std::vector<contact::ContactSample> samples;
  source->query(state.view(), samples);
  const long first = soft->soft()->evaluations();
  samples.clear();
  source->query(state.view(), samples);
  EXPECT_GT(samples.size(), 5u) << rings;
  EXPECT_EQ(soft->soft()->evaluations(), 2 * first) << "every query the same";
  return {skin.vertices.cols(), first, skin.faces.cols(), source->report().pruning->faces_a / 2};
}

}  // namespace

TEST(OutputSensitive, AQueryEvaluatesTheVerticesOfTheFacesHandedOn) {
  for (const int rings : {32, 64, 128}) {
    const Work w = work(rings, 8);
    EXPECT_GT(w.evaluated, 20) << rings;
    EXPECT_LT(w.handed_on, w.faces / 10) << rings;
    EXPECT_LT(w.evaluated, w.vertices / 10) << rings;
    // a patch has half as many vertices as faces, plus a number proportional to its border
    EXPECT_LT(static_cast<double>(w.evaluated),
              0.5 * static_cast<double>(w.handed_on) + 8.0 * std::sqrt(static_cast<double>(w.handed_on)))
        << rings;
  }
}
