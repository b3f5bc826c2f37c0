// Forces and tangents of material points: force as the gradient of an energy, and tangents against the
// derivatives of the force.
#include "surfaces.h"

using namespace contact_tests;

// Each skin point is carried by one tetrahedron, so that four nodes take all of its force.
TEST(MaterialPoints, ForceIsTheGradientOfItsEnergy) {
  SkinWorld skin;
  const TriMesh rest = mesh::sphere(1.0, 12);
  const auto lowest = skin.vertices.row(2).minCoeff();
  contact::MaterialPoints points = contact::material_points(skin.surface, rest.vertices, skin.ball, 0.05);
  contact::ContactForce term;
  term.add_frame(contact::fixed_frame());
  ContactSpec law;
  law.stiffness_pa_m = 1e4;
  term.add_pair(contact::make_box_source(std::move(points), 0, contact::fixed_frame(),
                                         {quaternion_of(Vec3(0.2, 0.3, 0.1)), Vec3(0.1, 0.1, lowest - 0.2)},
                                         Vec3(0.8, 0.9, 0.7), 0.05),
                law);
  term.refresh(skin.state.view());
  const VecX f = force(term, skin.state);
  ASSERT_GT(f.norm(), 1.0);
  std::mt19937 random(3);
  for (int i = 0; i < 5; ++i) {
    VecX d(f.size());
    for (auto& x : d) x = uniform(random);
    const double h = 1e-6;
    const auto energy = [&](double s) {
      const dynamics::State at = moved(skin.state, d, s);
      return term.energy(at.view());
    };
    EXPECT_NEAR((energy(h) - energy(-h)) / (2.0 * h), -f.dot(d), 1e-6 * f.norm());
  }
}

// In the tangent a hat function's overlap is k times its area, independently of its neighbours: exact for a
// translation. For tilting, a triangle of area A overestimates the second moment by A/12 sum (x_i - x_j)^2
// over its edges, which is h^2/6 times the area for right triangles with legs h, while a flat face with n of
// them per side has L^2/12.
TEST(MaterialPoints, ATangentIsTooStiffAgainstTilting) {
  constexpr double kSize = 0.04, kDown = 1e-6;
  for (const int n : {2, 4, 8}) {
    dynamics::State state;
    const int body = add_rigid_body(state, {Quat::Identity(), Vec3(0, 0, 0.5 * kSize - kDown)}, {});
    const auto frame = contact::block_frame(body);
    contact::ContactForce term;
    term.add_frame(frame);
    term.add_frame(contact::fixed_frame());
    ContactSpec law;
    law.stiffness_pa_m = 1e7;
    const contact::FrameSurface box{mesh::box_surface(Vec3::Constant(kSize), {n, n, 1}), 0, frame};
    term.add_pair(contact::make_plane_source(contact::material_points(box, HUGE_VAL), 1,
                                             contact::fixed_frame(), Vec3::Zero(), Vec3::UnitZ(), 1e-3),
                  law);
    term.refresh(state.view());
    const auto stiffness_over_slope = [&](int along) {
      const VecX d = VecX::Unit(6, along);
      constexpr double h = 1e-7;
      VecX y = VecX::Zero(6);
      term.apply_tangent(state.view(), 1.0, 0.0, d, y);
      return 2.0 * h * y[along] / (force(term, moved(state, d, -h)) - force(term, moved(state, d, h)))[along];
    };
    EXPECT_NEAR(stiffness_over_slope(5), 1.0, 1e-3);
    EXPECT_NEAR(stiffness_over_slope(0), 1.0 + 2.0 / (n * n), 2e-3) << n;
  }
}

// Sticking friction is a spring: its tangent is the force's derivative by positions across the normal while
// the spring is below its maximum length, and zero beyond. The dependence of friction on pressure is left out
// along the normal.
TEST(MaterialPoints, WhatSticksHasItsTangent) {
  const TriMesh rest = flat_block();
  SurfaceWorld world{rest};
  ContactSpec law;
  law.stiffness_pa_m = 1e6;
  law.friction = 0.4;
  law.friction_regularisation_m_s = 1e-2;
  law.friction_retardation_s = 1e-2;  // maximum spring length 0.1 mm
  for (const bool at_longest : {false, true}) {
    contact::ContactForce term;
    term.add_frame(contact::fixed_frame());
    term.add_pair(
        contact::make_plane_source(contact::material_points(world.surface, rest.vertices, {}, 1.0), 0,
                                   contact::fixed_frame(), Vec3(0, 0, -0.249), Vec3::UnitZ(), 0.01),
        law);
    world.state.q().tail(rest.vertices.size()) = rest.vertices.reshaped();
    term.refresh(world.state.view());
    EXPECT_EQ(force(term, world.state).head<2>().norm(), 0.0);
    const int size = world.state.layout().u_size;
    VecX along = VecX::Zero(size);
    for (Eigen::Index i = 0; i < rest.vertices.cols(); ++i)
      along.tail(rest.vertices.size()).segment<3>(3 * i) = Vec3(0.6, 0.8, 0.0);
    world.state.q() += (at_longest ? 3e-4 : 5e-5) * along;
    const VecX f = force(term, world.state);
    double pressed = 0.0;
    for (Eigen::Index i = 2; i < f.size(); i += 3) pressed += f[i];
    const double share = -f.dot(along) / (0.4 * pressed);
    EXPECT_GT(pressed, 1e3);
    EXPECT_NEAR(share, at_longest ? 1.0 : 0.5, 1e-9);
    VecX K = VecX::Zero(size);
    term.apply_tangent(world.state.view(), 1.0, 0.0, along, K);
    if (at_longest)
      EXPECT_LT(K.norm(), 1e-9 * f.norm() / 1e-4);
    else
      expect_derivative([&](double h) { return force(term, moved(world.state, along, h)); }, -K, 1e-6,
                        "along the surface");
    const dynamics::BorderedMatrix A = step_matrix(term, world.state, 1.0, 0.0);
    VecX assembled;
    A.multiply(along, assembled);
    EXPECT_LT((assembled - K).norm(), 1e-12 * f.norm() / 1e-4);
  }
}
