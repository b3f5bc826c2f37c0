// A soft ball against a rigid tool with a hollow: force and moment by theory, however many hulls stand for
// the tool.
#include <gtest/gtest.h>

#include "backends.h"
#include "grid_proxies.h"
#include "palpate/proxy/pruner.h"
#include "proxy/tools.h"
#include "surfaces.h"

using namespace contact_tests;

namespace {

constexpr double kRing = 2.0, kTube = 0.4, kDepth = 0.03, kGap = 0.02;

/// A ball of tetrahedra of radius 1 with a fine sphere for its skin, about a point.
struct BallWorld {
  TetMesh ball = mesh::ball(1.0, 0.45);
  TriMesh skin = mesh::sphere(1.0, 40);
  dynamics::State state;
  contact::NodeSurface surface;

  explicit BallWorld(const Pose& pose) {
    dynamics::BlockSpec nodes;
    nodes.name = "ball";
    nodes.q_size = nodes.u_size = static_cast<int>(ball.nodes.size());
    const Points placed = (pose.rotation.toRotationMatrix() * ball.nodes).colwise() + pose.translation;
    surface.block_id =
        state.insert(nodes, Eigen::Map<const VecX>(placed.data(), placed.size()), VecX::Zero(placed.size()));
    surface.faces = skin.faces;
    surface.embedding = mesh::embed(ball, skin.vertices);
    surface.tets = ball.tets;
  }
};

struct Seen {
  Total total;
  proxy::PruneCounts counts;
  double share_a = 0.0, share_b = 0.0;  ///< of the faces, handed on
};

/// The ball at a point of the tool's frame, which is itself rotated and moved; force and moment in that
/// frame.
Seen seen(const TriMesh& tool, const Vec3& ball_in_tool, const proxy::SolidOptions& cut) {
  const Pose frame{Quat(0.8, 0.2, -0.5, 0.3).normalized(), Vec3(0.4, -2.0, 1.0)};
  const BallWorld world({Quat(0.6, -0.2, 0.1, 0.7).normalized(), frame * ball_in_tool});
  const auto source = contact::make_image_source(
      world.surface, proxies_of(world.ball, world.skin, world.surface.embedding, 4), tool,
      proxies_of(tool, cut), 0, contact::fixed_frame(frame), image_options(256, kGap));
  std::vector<contact::ContactSample> samples;
  source->query(world.state.view(), samples);
  Seen out{total(samples, world.state.view()), *source->pruning()};
  out.total.moment =
      frame.rotation.conjugate() * Vec3(out.total.moment - frame.translation.cross(out.total.force));
  out.total.force = frame.rotation.conjugate() * out.total.force;
  out.share_a = static_cast<double>(out.counts.faces_a) / static_cast<double>(world.skin.faces.cols());
  out.share_b = static_cast<double>(out.counts.faces_b) / static_cast<double>(tool.faces.cols());
  return out;
}

/// Volume of ball and torus in common, by the midpoint rule over the plane that its force is normal to: along
/// x the ball reaches to sqrt(1 - y^2 - z^2) from its middle, the torus to sqrt(rho^2 - y^2) from the axis,
/// rho = R -+ sqrt(r^2 - z^2) on the side of the hole or outside.
double overlap(double ball, bool in_hole) {
  constexpr double kWidth = 0.7, kCell = 1e-3;
  double sum = 0.0;
  for (double y = -kWidth + 0.5 * kCell; y < kWidth; y += kCell)
    for (double z = -kTube + 0.5 * kCell; z < kTube; z += kCell) {
      const double tube = std::sqrt(kTube * kTube - z * z), of_ball = std::sqrt(1.0 - y * y - z * z);
      const double rho = in_hole ? kRing - tube : kRing + tube, of_ring = std::sqrt(rho * rho - y * y);
      sum += std::max(0.0, in_hole ? ball + of_ball - of_ring : of_ring - ball + of_ball) * kCell * kCell;
    }
  return sum;
}

void expect_alike(const Seen& one, const Seen& other, const char* what) {
  EXPECT_LT((one.total.force - other.total.force).norm(), 0.01 * other.total.force.norm()) << what;
  // about the tool's middle, lengths of 1
  EXPECT_LT((one.total.moment - other.total.moment).norm(), 0.01 * other.total.force.norm()) << what;
}

}  // namespace

ON_EACH_BACKEND(ConcaveTool);

// The ball presses the ring from inside the hole, where the tube bends away from it along and towards it
// around, and from outside, where it bends away both ways. Facets take away some of the depth: on average h^2
// / 8 R inside a sphere (equilateral, of edge h), h^2 / 12 R along a circle, which around the hole stands
// out. The prong's end is a plane to the ball: a cap of volume pi d^2 (3 - d) / 3.
TEST_P(ConcaveTool, ForceDoesNotDependOnItsCut) {
  const TriMesh ring = tools::torus(kRing, kTube, 240, 120), fork = tools::fork(8);
  const double in_hole = kRing - kTube - 1.0 + kDepth, outside = kRing + kTube + 1.0 - kDepth;
  const double of_ball = 4 * M_PI / (20 * 40 * 40) * 4 / std::sqrt(3.0) / 8,
               of_tube = std::pow(2 * M_PI / 120, 2) * kTube / 12;
  const double around_hole = std::pow(2 * M_PI / 240, 2) * (kRing - kTube) / 12,
               around = std::pow(2 * M_PI / 240, 2) * (kRing + kTube) / 12;
  const double in_hole_lost = of_ball + of_tube - around_hole, outside_lost = of_ball + of_tube + around,
               cap = kDepth - of_ball;
  const struct {
    const char* name;
    const TriMesh& tool;
    Vec3 ball, force;  // in the tool's frame
  } cases[] = {{"in the hole", ring, Vec3(in_hole, 0, 0), Vec3(-overlap(in_hole - in_hole_lost, true), 0, 0)},
               {"outside", ring, Vec3(outside, 0, 0), Vec3(overlap(outside + outside_lost, false), 0, 0)},
               {"prong", fork, Vec3(1, 0, kDepth - 1.0), Vec3(0, 0, -M_PI * cap * cap * (3.0 - cap) / 3.0)}};
  for (const auto& c : cases) {
    const Seen one = seen(c.tool, c.ball, {.count = 1}),
               few = seen(c.tool, c.ball, {.count = 8, .tolerance = 0.0}),
               many = seen(c.tool, c.ball, {.count = 64, .tolerance = 0.0});
    for (const Seen* s : {&one, &few, &many}) {
      EXPECT_LT((s->total.force - c.force).norm(), 0.01 * c.force.norm())
          << c.name << ": " << s->total.force.transpose() << " of " << c.force.transpose();
      EXPECT_LT((s->total.moment - c.ball.cross(c.force)).norm(), 0.01 * c.force.norm())
          << c.name << ": " << s->total.moment.transpose();
      EXPECT_GT(s->total.pressed, 1000) << c.name;
    }
    expect_alike(few, one, c.name);
    expect_alike(many, one, c.name);
    const std::string name = c.name;
    RecordProperty(name + ", ball handed on by one, few, many [ppm]",
                   std::to_string(std::lround(1e6 * one.share_a)) + " " +
                       std::to_string(std::lround(1e6 * few.share_a)) + " " +
                       std::to_string(std::lround(1e6 * many.share_a)));
    RecordProperty(name + ", force of few, many off one [ppm]",
                   std::to_string(std::lround(1e6 * (few.total.force - one.total.force).norm() /
                                              one.total.force.norm())) +
                       " " +
                       std::to_string(std::lround(1e6 * (many.total.force - one.total.force).norm() /
                                                  one.total.force.norm())));
    if (&c == cases) { EXPECT_LT(few.share_a, 0.3 * one.share_a) << "one hull closes the hole"; }
  }
}
