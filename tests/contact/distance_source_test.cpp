// Contact by nearest points: the samples' forces are the gradient of an energy, balanced, and as smooth as
// the skins.
#include "two_balls.h"

using namespace contact_tests;

namespace {

constexpr double kStiffness = 1e4;

ContactSpec law() {
  ContactSpec out;
  out.stiffness_pa_m = kStiffness;
  return out;
}

/// A soft ball whose vertices are nodes, and a smaller ball, soft or rigid, pressed into its side.
struct Balls {
  SurfaceWorld a{sphere(Vec3::Zero(), 1.0, 14)};
  TriMesh other;
  contact::NodeSurface b;
  int body = -1;
  contact::ContactForce term;

  enum class Other { kSoft, kGiven, kInState };
  explicit Balls(Other kind, const Vec3& at = Vec3(0.7, 0.6, 0.9)) : other(sphere(at, 0.5, 9)) {
    const Points rest_a = vertices_of(a.state, a.surface.block_id);
    if (kind == Other::kSoft) {
      dynamics::BlockSpec nodes;
      nodes.name = "small";
      nodes.q_size = nodes.u_size = static_cast<int>(other.vertices.size());
      b = a.surface;
      b.block_id = a.state.insert(nodes, Eigen::Map<const VecX>(other.vertices.data(), other.vertices.size()),
                                  VecX::Zero(nodes.u_size));
      b.node_of_vertex.resize(static_cast<std::size_t>(other.vertices.cols()));
      b.faces = other.faces;
      term.add_pair(contact::make_distance_source(a.surface, rest_a, b, other.vertices,
                                                  {.quadrature_error = 0.1, .candidate_gap = 0.1}),
                    law());
    } else {
      TriMesh rigid = other;
      rigid.vertices.colwise() -= at;
      std::shared_ptr<contact::MovingFrame> frame = contact::fixed_frame(Pose{Quat::Identity(), at});
      if (kind == Other::kInState) {
        body = add_rigid_body(a.state, Pose{quaternion_of(Vec3(0.3, -0.2, 0.5)), at}, {});
        frame = contact::block_frame(body);
      }
      term.add_frame(frame);
      term.add_pair(contact::make_distance_source(a.surface, rest_a, contact::FrameSurface{rigid, 0, frame},
                                                  {.quadrature_error = 0.1, .candidate_gap = 0.1}),
                    law());
    }
    term.refresh(a.state.view());
  }
  static Points vertices_of(const dynamics::State& state, int block) {
    const dynamics::Block* b = state.layout().find(block);
    return Eigen::Map<const Points>(state.q().data() + b->q_offset, 3, b->q_size / 3);
  }
};

VecX direction(Eigen::Index size, unsigned seed) {
  std::mt19937 random(seed);
  VecX out(size);
  for (auto& x : out) x = uniform(random);
  return out;
}

/// Force and moment about the origin of all nodes and bodies, and the sum of the force magnitudes.
struct Sum {
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  double size = 0.0;
};
Sum sum_of(const dynamics::State& state, const VecX& f) {
  Sum out;
  for (const auto& block : state.layout().blocks) {
    if (block.kind == dynamics::BlockKind::kRigidBody) {
      const Vec3 force = f.segment<3>(block.u_offset + 3);
      out.force += force;
      out.moment +=
          f.segment<3>(block.u_offset) + Vec3(state.q().segment<3>(block.q_offset + 4)).cross(force);
      out.size += force.norm();
      continue;
    }
    for (int i = 0; i < block.u_size; i += 3) {
      const Vec3 force = f.segment<3>(block.u_offset + i);
      out.force += force;
      out.moment += Vec3(state.q().segment<3>(block.q_offset + i)).cross(force);
      out.size += force.norm();
    }
  }
  return out;
}

}  // namespace

// f = -dU/dq. Central differences of step h have an error of h^2 times U's third derivative, which jumps
// where a foot crosses an edge or a point separates: of hundreds of points a few do so within a step.
TEST(DistanceSource, ForceIsTheGradientOfItsEnergy) {
  for (const auto kind : {Balls::Other::kSoft, Balls::Other::kGiven, Balls::Other::kInState}) {
    Balls balls(kind);
    const VecX f = force(balls.term, balls.a.state);
    ASSERT_GT(f.norm(), 1.0);
    for (unsigned seed = 1; seed <= 5; ++seed) {
      const VecX d = direction(f.size(), seed);
      const double h = 1e-6;
      const auto energy = [&](double s) {
        const dynamics::State at = moved(balls.a.state, d, s);
        return balls.term.energy(at.view());
      };
      EXPECT_NEAR((energy(h) - energy(-h)) / (2.0 * h), -f.dot(d), 1e-6 * f.norm()) << seed;
    }
  }
}

TEST(DistanceSource, ForcesBalance) {
  for (const auto kind : {Balls::Other::kSoft, Balls::Other::kInState}) {
    Balls balls(kind);
    const Sum sum = sum_of(balls.a.state, force(balls.term, balls.a.state));
    EXPECT_GT(sum.size, 1.0);
    EXPECT_LT(sum.force.norm(), 1e-13 * sum.size);
    EXPECT_LT(sum.moment.norm(), 1e-13 * sum.size);
  }
}

// Fine skins in coarse tetrahedra; each skin point is carried by one tetrahedron.
TEST(DistanceSource, ForcesBalanceOnSkins) {
  TwoBalls balls;
  contact::ContactForce term;
  term.add_pair(contact::make_distance_source(balls.a.surface, balls.a.model.skin.vertices, balls.b.surface,
                                              balls.b.model.skin.vertices, {.candidate_gap = 0.02}),
                law());
  term.refresh(balls.state.view());
  const VecX f = force(term, balls.state);
  const Sum sum = sum_of(balls.state, f);
  EXPECT_GT(sum.size, 1.0);
  EXPECT_LT(sum.force.norm(), 1e-12 * sum.size);
  EXPECT_LT(sum.moment.norm(), 1e-12 * sum.size);
  double worst = 0.0;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const VecX d = direction(f.size(), seed);
    const auto energy = [&](double s) { return term.energy(moved(balls.state, d, s).view()); };
    worst = std::max(worst, std::abs((energy(1e-6) - energy(-1e-6)) / 2e-6 + f.dot(d)) / f.norm());
  }
  EXPECT_LT(worst, 0.03) << "what the tetrahedra's strains differ by";
}

// Samples that follow the state equal those of a query at that state, also where feet moved to other faces.
TEST(DistanceSource, FollowsAsAQueryFinds) {
  for (const auto kind : {Balls::Other::kSoft, Balls::Other::kGiven}) {
    Balls exact(kind), fresh(kind);
    const VecX before = force(fresh.term, fresh.a.state);
    for (Balls* one : {&exact, &fresh}) {
      const dynamics::Block* block = one->a.state.layout().find(one->a.surface.block_id);
      for (int i = 0; i < block->q_size; i += 3) {
        auto x = one->a.state.q().segment<3>(block->q_offset + i);
        x = quaternion_of(Vec3(0.0, 0.02, 0.04)) * Vec3(1.01 * x) + Vec3(0.005, 0.0, 0.005);
      }
    }
    fresh.term.refresh(fresh.a.state.view());
    const VecX requested = force(fresh.term, fresh.a.state);
    EXPECT_LT((force(exact.term, exact.a.state) - requested).norm(), 1e-9 * requested.norm());
    EXPECT_GT((before - requested).norm(), 0.1 * requested.norm()) << "else there is nothing to follow";
    EXPECT_EQ(exact.term.statistics().queries, 1);
  }
}

// Two soft bodies slide far between queries: the tangent stays within the blocks announced by the query.
TEST(DistanceSource, TangentOfWhatFollowsStaysInThePattern) {
  Balls balls(Balls::Other::kSoft);
  dynamics::BorderedMatrix A = step_matrix(balls.term, balls.a.state, 1.0, 0.0);
  const dynamics::Block* block = balls.a.state.layout().find(balls.b.block_id);
  for (int i = 0; i < block->q_size; i += 3) {
    auto x = balls.a.state.q().segment<3>(block->q_offset + i);
    x = quaternion_of(Vec3(0.0, 0.0, 0.6)) * Vec3(x);
  }
  const double before =
      A.body.values().empty()
          ? 0.0
          : Eigen::Map<const VecX>(A.body.values().data(), static_cast<Eigen::Index>(A.body.values().size()))
                .norm();
  EXPECT_NO_THROW(balls.term.add_tangent(balls.a.state.view(), 1.0, 0.0, A));
  EXPECT_NE(Eigen::Map<const VecX>(A.body.values().data(), static_cast<Eigen::Index>(A.body.values().size()))
                .norm(),
            before);
}

// A ball of radius R, delta deep in a half-space: k pi R delta^2 (1 - delta / (2 R)) by the points of both
// (tests/distance/skin_contact_test.cpp), and no moment about its centre.
TEST(DistanceSource, BallInHalfSpace) {
  TriMesh ball = mesh::sphere(1.0, 40);
  SurfaceWorld world(ball);
  TriMesh floor = mesh::box_surface(Vec3(4.0, 4.0, 2.0), {8, 8, 4});
  const double delta = 0.1;
  const double top = floor.vertices.row(2).maxCoeff();
  floor.vertices.row(2).array() += -1.0 + delta - top;
  const auto frame = contact::fixed_frame();
  contact::ContactForce term;
  term.add_frame(frame);
  term.add_pair(
      contact::make_distance_source(world.surface, ball.vertices, contact::FrameSurface{floor, 0, frame},
                                    {.quadrature_error = 3e-3}),
      law());
  term.refresh(world.state.view());
  const VecX f = force(term, world.state);
  const Sum sum = sum_of(world.state, f);
  EXPECT_NEAR(sum.force.z() / (kStiffness * kPi * delta * delta * (1.0 - delta / 2.0)), 1.0, 0.01);
  EXPECT_LT(sum.force.head<2>().norm(), 1e-3 * sum.force.z());
  EXPECT_LT(sum.moment.norm(), 1e-3 * sum.force.z());
}

// A foot may move from one face to another, which turns its force by the angle between the faces: along a
// path of small steps, the force changes by the amount of the previous step, plus at most that angle times
// one point's share.
TEST(DistanceSource, ForceIsContinuousAlongAPath) {
  Balls balls(Balls::Other::kInState);  // rotated, so that no row of points crosses an edge at once
  const dynamics::Block* block = balls.a.state.layout().find(balls.a.surface.block_id);
  const auto resultant = [&] {
    Vec3 sum = Vec3::Zero();
    const VecX f = force(balls.term, balls.a.state);
    for (int i = 0; i < block->u_size; i += 3) sum += f.segment<3>(block->u_offset + i);
    return sum;
  };
  std::vector<Vec3> along;
  for (int step = 0; step < 300; ++step) {
    for (int i = 0; i < block->q_size; i += 3) {
      auto x = balls.a.state.q().segment<3>(block->q_offset + i);
      x = quaternion_of(Vec3(1e-4, 2e-4, -1e-4)) * Vec3(x);
    }
    if (step % 10 == 0) balls.term.refresh(balls.a.state.view());
    along.push_back(resultant());
  }
  double share = 0.0, jump = 0.0;
  for (const contact::ContactSample& s : balls.term.samples())
    share = std::max(share, -s.gap * s.area * kStiffness / along.back().norm());
  for (std::size_t i = 2; i < along.size(); ++i)
    jump = std::max(jump, (along[i] - 2.0 * along[i - 1] + along[i - 2]).norm() / along[i].norm());
  EXPECT_GT(share, 0.01);
  constexpr double kEdge = kPi / 9.0;  // angle between adjacent faces of the small ball
  EXPECT_LT(jump, 2.0 * share * kEdge) << "two points at once";
}
