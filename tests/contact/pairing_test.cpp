// What a query changes beside what the tangent says: points are paired anew, areas and the normal follow.
//
// Between two queries a sample keeps its points, area A and normal n.  Let body a move by u, its skin the
// height w_a over the contact plane, w_b that of b, depth d = w_b - w_a over the overlap, where d > 0.  In
// the frozen samples the force k sum A d along n changes by
//     frozen   -k int u_n dA.
// The depth at a fixed line along n changes by  -u_n + grad w_a . u_t, so that a query finds
//     fresh    -k int (u_n - grad w_a . u_t) dA,
// and since  grad w_a = grad w_b - grad d  and d = 0 on the overlap's border,
//     fresh - frozen = k int d div u_t dA   +   k int grad w_b . u_t dA:
// the area of the skin that bears the pressure, which grows with its stretch, and the way along the other
// skin.  For a rigid motion the first is zero, and the second as well where n is the overlap's own normal
// (the mean slope of both skins vanishes along it; pruned_region.cpp).  The border moves, but there is no
// depth. Last, n itself follows the skins.  For two spheres it is the line of centres, D apart, and a
// sideways step s turns it by s/D: a lateral force F s/D, away from the middle where both are convex, and
// back to it in a round dent, where D is the difference of radii.
//
// None of the three is in K.  Against the normal stiffness k A_c of a contact of area A_c, mean depth d =
// F/(k A_c), they are d div u_t to u_n, and d/D: small where the depth is small against the shape.
#include "backends.h"
#include "grid_proxies.h"
#include "surfaces.h"

using namespace contact_tests;

namespace {

constexpr double kStiffness = 1e5;
ContactSpec law() {
  ContactSpec out;
  out.stiffness_pa_m = kStiffness;
  return out;
}

/// A ball's skin of radius 1 over a rigid ball of radius 0.8, by proxies, so that its normal is the
/// overlap's.
struct TwoSpheres {
  TetMesh ball = mesh::ball(1.0, 0.45);
  TriMesh skin = mesh::sphere(1.0, 40), rigid = mesh::sphere(0.8, 40);
  dynamics::State state;
  contact::ContactForce term;
  static constexpr double kApart = 1.7;  // of the centres
  Vec3 axis = Vec3(0.2, -0.1, 1.0).normalized();

  TwoSpheres() {
    dynamics::BlockSpec nodes;
    nodes.name = "ball";
    nodes.q_size = nodes.u_size = static_cast<int>(ball.nodes.size());
    contact::NodeSurface surface;
    surface.embedding = mesh::embed(ball, skin.vertices);
    surface.faces = skin.faces;
    surface.tets = ball.tets;
    const auto proxies = proxies_of(ball, skin, surface.embedding, 2);
    Points moved = ball.nodes;
    moved.colwise() += Vec3(kApart * axis);
    surface.block_id =
        state.insert(nodes, Eigen::Map<const VecX>(moved.data(), moved.size()), VecX::Zero(moved.size()));
    term.add_frame(contact::fixed_frame());
    contact::ImageOptions options;
    options.pixels = 512;
    options.candidate_gap = 0.02;
    term.add_pair(contact::make_image_source(surface, proxies, rigid, proxies_of(rigid), 0,
                                             contact::fixed_frame(), options),
                  law());
  }
  Vec3 resultant() {
    return -term.frame_wrench(state.view(), 0).force;  // on the ball
  }
  void shift(const Vec3& by) {
    for (Eigen::Index i = 0; i < state.q().size(); i += 3) state.q().segment<3>(i) += by;
  }
  /// The resultant that K predicts after a rigid shift, and that of a fresh query there.
  std::pair<Vec3, Vec3> predicted_and_fresh(const Vec3& by) {
    term.refresh(state.view());
    const Vec3 before = resultant();
    VecX x(state.layout().u_size), y = VecX::Zero(x.size());
    for (Eigen::Index i = 0; i < x.size(); i += 3) x.segment<3>(i) = by;
    term.apply_tangent(state.view(), 1.0, 0.0, x, y);
    Vec3 change = Vec3::Zero();
    for (Eigen::Index i = 0; i < x.size(); i += 3) change -= y.segment<3>(i);
    shift(by);
    term.refresh(state.view());
    const Vec3 fresh = resultant();
    shift(-by);
    return {before + change, fresh};
  }
};

}  // namespace

// Along n the tangent is the derivative of a fresh query: what is left falls with the square of the step.
TEST(Pairing, ApproachIsInTheTangent) {
  TwoSpheres spheres;
  spheres.term.refresh(spheres.state.view());
  const double force = spheres.resultant().norm();
  // k V: the overlap of spheres of 1 and 0.8
  const double D = TwoSpheres::kApart, h = 1.8 - D,
               volume = M_PI * h * h * (D * D + 2.0 * D * 1.8 - 3.0 * 0.04) / (12.0 * D);
  EXPECT_NEAR(force / (kStiffness * volume), 1.0, 0.04) << "facets of 40 rings";
  double before = 0.0;
  for (const double step : {0.02, 0.01, 0.005}) {
    const auto [predicted, fresh] = spheres.predicted_and_fresh(-step * spheres.axis);
    const double left = (fresh - predicted).dot(spheres.axis), change = (fresh.norm() - force);
    EXPECT_GT(change, 10.0 * step * force) << "there is something to predict";
    // V''/2 step^2; dV/dD is the overlap's area seen along n, pi a^2, to leading order pi 2 R' h
    const double second = 0.5 * kStiffness * 2.0 * M_PI * (0.8 / 1.8) * step * step;
    EXPECT_NEAR(left / second, 1.0, 0.15) << step;
    if (before > 0.0) { EXPECT_NEAR(std::log2(before / left), 2.0, 0.15) << step; }
    before = left;
  }
}

// Sideways K says that nothing happens; a fresh query finds the normal turned by s/D, and the force with it.
TEST(Pairing, TheTurnOfTheNormalIsNotInTheTangent) {
  TwoSpheres spheres;
  spheres.term.refresh(spheres.state.view());
  const Vec3 along = spheres.axis.unitOrthogonal(), at_rest = spheres.resultant();
  const double force = at_rest.norm();
  for (const double step : {0.02, 0.04}) {
    const auto [predicted, fresh] = spheres.predicted_and_fresh(step * along);
    EXPECT_LT((predicted - at_rest).dot(along) / force, 0.02 * step) << "n n^T: nothing";
    EXPECT_NEAR((fresh - at_rest).dot(along) / (force * step / TwoSpheres::kApart), 1.0, 0.1) << step;
    // along n, to second order: the centres are farther apart by s^2/(2 D), times k pi a^2
    const double lost = kStiffness * 2.0 * M_PI * (0.8 / 1.8) * 0.1 * 0.5 * step * step / TwoSpheres::kApart;
    EXPECT_NEAR((at_rest - fresh).dot(spheres.axis) / lost, 1.0, 0.15) << step;
  }
}

// A flat skin stretched by e in both directions bears the pressure on 1 + 2 e times the area; K knows none of
// it.
TEST(Pairing, TheStretchOfTheSkinIsNotInTheTangent) {
  constexpr double kDepth = 0.01;
  constexpr int kEdge = 8;
  TriMesh sheet;
  sheet.vertices.resize(3, (kEdge + 1) * (kEdge + 1));
  sheet.faces.resize(3, 2 * kEdge * kEdge);
  for (int i = 0, f = 0; i <= kEdge; ++i)
    for (int j = 0; j <= kEdge; ++j) {
      const int at = i * (kEdge + 1) + j;
      sheet.vertices.col(at) = Vec3(2.0 * i / kEdge - 1.0, 2.0 * j / kEdge - 1.0, -kDepth);
      if (i == kEdge || j == kEdge) continue;
      sheet.faces.col(f++) = Eigen::Vector3i(at, at + kEdge + 2, at + kEdge + 1);
      sheet.faces.col(f++) = Eigen::Vector3i(at, at + 1, at + kEdge + 2);
    }
  TriMesh floor = sheet;  // larger, and facing up
  floor.vertices.topRows<2>() *= 2.0;
  floor.vertices.row(2).setZero();
  floor.faces.row(1).swap(floor.faces.row(2));
  floor = closed_by_cone(floor, Vec3(0, 0, -1));
  SurfaceWorld world(closed_by_cone(sheet, Vec3(0, 0, 1)));
  contact::ContactForce term;
  term.add_frame(contact::fixed_frame());
  contact::ImageOptions options;
  options.pixels = 1024;
  options.candidate_gap = 0.02;
  term.add_pair(contact::make_image_source(world.surface, floor, 0, contact::fixed_frame(), options), law());
  term.refresh(world.state.view());
  const auto lift = [&] { return -term.frame_wrench(world.state.view(), 0).force.z(); };
  const double before = lift();
  EXPECT_NEAR(before / (kStiffness * kDepth * 4.0), 1.0, 5e-3);
  VecX stretch = VecX::Zero(world.state.layout().u_size), y = stretch;
  for (Eigen::Index i = 6; i < stretch.size(); i += 3) stretch.segment<2>(i) = world.state.q().segment<2>(i);
  term.apply_tangent(world.state.view(), 1.0, 0.0, stretch, y);
  EXPECT_LT(y.norm(), 1e-12 * before);
  constexpr double kStrain = 0.05;
  world.state.q() += kStrain * stretch;
  EXPECT_NEAR(lift(), before, 1e-12 * before) << "frozen areas";
  term.refresh(world.state.view());
  EXPECT_NEAR(lift() / before, (1.0 + kStrain) * (1.0 + kStrain), 5e-3) << "a fresh query";
}
