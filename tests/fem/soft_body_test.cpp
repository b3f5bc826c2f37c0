#include "fem_fixture.h"

using namespace palpate;
using namespace palpate::fem;
using namespace palpate::fem::testing;

TEST(SoftBody, TwoBodiesInOneStateDoNotMix) {
  const TetMesh first = jittered_cube(1, 0.1, 31), second = jittered_cube(2, 0.1, 32);
  Random random(33);
  const VecX xa = flat(first.nodes) + 0.1 * random.vector(3 * first.nodes.cols());
  const VecX xb = flat(second.nodes) + 0.1 * random.vector(3 * second.nodes.cols());
  const auto na = xa.size(), nb = xb.size();
  dynamics::State state(static_cast<int>(na + nb), static_cast<int>(na + nb));
  dynamics::BlockSpec spec;
  spec.q_size = spec.u_size = static_cast<int>(na);
  const int ia = state.insert(spec, xa, VecX::Zero(na));
  spec.q_size = spec.u_size = static_cast<int>(nb);
  const int ib = state.insert(spec, xb, VecX::Zero(nb));
  SoftBody a("a", first, soft_material(), {}, ia), b("b", second, soft_material(), {}, ib);
  VecX f = VecX::Zero(na + nb), alone = VecX::Zero(nb);
  b.add_force(state.view(), f);
  EXPECT_EQ(f.head(na).norm(), 0.0);
  OneBody only_b(xb, VecX::Zero(nb));
  SoftBody b_alone("b", second, soft_material(), {}, only_b.id);
  b_alone.add_force(only_b.state.view(), alone);
  EXPECT_EQ((f.tail(nb) - alone).norm(), 0.0);
  // The assembled matrix has each body's K on the body's diagonal block.
  dynamics::PatternBuilder builder(state.layout()), builder_b(only_b.state.layout());
  a.add_pattern(builder);
  b.add_pattern(builder);
  b_alone.add_pattern(builder_b);
  dynamics::BorderedMatrix A, B;
  A.body = builder.build();
  B.body = builder_b.build();
  a.add_tangent(state.view(), 1, 0, A);
  b.add_tangent(state.view(), 1, 0, A);
  b_alone.add_tangent(only_b.state.view(), 1, 0, B);
  const MatX dense = A.to_dense();
  EXPECT_EQ((dense.bottomRightCorner(nb, nb) - B.to_dense()).norm(), 0.0);
  EXPECT_EQ(dense.topRightCorner(na, nb).norm(), 0.0);
}

TEST(SoftBody, UniaxialStressShowsAsVonMises) {
  // F = diag(l, t, t), t = 1 - nu (l - 1): S_xx is the only stress, T_xx = E (l - 1), Cauchy stress T_xx l /
  // (l t^2).
  const TetMesh rest = jittered_cube(2, 0.1, 34);
  const Material m = soft_material();
  const double l = 1.2, t = 1.0 - m.poissons_ratio * (l - 1.0);
  const OneBody at(flat(Vec3(l, t, t).asDiagonal() * rest.nodes), VecX::Zero(3 * rest.nodes.cols()));
  SoftBody body("b", rest, m, {}, at.id);
  const VecX stress = body.nodal_stress(at.state.view());
  EXPECT_EQ(stress.size(), rest.nodes.cols());
  const double expected = m.youngs_modulus * (l - 1.0) / (t * t);
  EXPECT_LT((stress.array() - expected).abs().maxCoeff(), 1e-12 * expected);
}

TEST(SoftBody, EnergyOfAUniformStretch) {
  // psi = mu sum (s_i - 1)^2 + lambda/2 (sum (s_i - 1))^2, times the volume of the unit cube.
  const TetMesh rest = jittered_cube(2, 0.0, 35);
  const Material m = soft_material();
  const OneBody at(flat(Vec3(1.3, 0.9, 1.1).asDiagonal() * rest.nodes), VecX::Zero(3 * rest.nodes.cols()));
  SoftBody body("b", rest, m, {}, at.id);
  const double expected = m.mu() * (0.09 + 0.01 + 0.01) + 0.5 * m.lambda() * 0.3 * 0.3;
  EXPECT_NEAR(body.energy(at.state.view()), expected, 1e-14);
}

TEST(SoftBody, VolumetricShareIsOfLambdaAlone) {
  // With half the share, the energy of a uniform stretch has half its lambda part: mu sum (s_i - 1)^2 +
  // lambda/4 (sum (s_i - 1))^2.
  const TetMesh rest = jittered_cube(1, 0.0, 36);
  const Material m = soft_material();
  const OneBody at(flat(Vec3(1.3, 0.9, 1.1).asDiagonal() * rest.nodes), VecX::Zero(3 * rest.nodes.cols()));
  SoftBody body("b", rest, m, {.volumetric_share = 0.5}, at.id);
  EXPECT_NEAR(body.energy(at.state.view()), m.mu() * (0.09 + 0.01 + 0.01) + 0.25 * m.lambda() * 0.3 * 0.3,
              1e-14);
  EXPECT_EQ(body.materials()[0].lambda(), m.lambda());
}

TEST(SoftBody, NewMaterialTakesEffectAtTheNextEvaluation) {
  const TetMesh rest = one_tet();
  const OneBody at(flat(1.1 * rest.nodes), VecX::Zero(12));
  SoftBody body("b", rest, soft_material(), {}, at.id);
  const double before = body.energy(at.state.view());
  Material twice = soft_material();
  twice.youngs_modulus *= 2.0;
  body.set_materials({twice});
  EXPECT_DOUBLE_EQ(body.energy(at.state.view()), 2.0 * before);
  EXPECT_EQ(body.materials()[0].youngs_modulus, twice.youngs_modulus);
  EXPECT_EQ(body.node_count(), 4);
  EXPECT_EQ(body.element_count(), 1);
  EXPECT_EQ(body.name(), "b");
}

TEST(SoftBody, CountsInvertedElementsOnly) {
  const TetMesh rest = one_tet();
  SoftBody body("b", rest, soft_material(), {}, 0);
  VecX f = VecX::Zero(12);
  const auto inverted = [&](const Vec3& stretches) {
    body.reset_counts();
    const OneBody at(flat(stretches.asDiagonal() * rest.nodes), VecX::Zero(12));
    body.add_force(at.state.view(), f);
    return body.counts().inverted;
  };
  EXPECT_EQ(inverted({1.0, 1.0, 0.1}), 0);
  EXPECT_EQ(inverted({1.0, 1.0, 0.0}), 1);
  EXPECT_EQ(inverted({1.0, 1.0, -0.1}), 1);
}

TEST(SoftBody, RefusesBadMeshesWithElementAndValue) {
  TetMesh inverted = one_tet();
  std::swap(inverted.tets(0, 0), inverted.tets(1, 0));
  const std::string message = message_of([&] { SoftBody("liver", inverted, soft_material(), {}, 0); });
  expect_contains(message, "body \"liver\": element 0 (nodes 1 0 2 3) has volume -0.");
  expect_contains(message, "must be positive");
  TetMesh flat_tet = one_tet();
  flat_tet.nodes.row(2).setZero();
  expect_contains(message_of([&] { SoftBody("b", flat_tet, soft_material(), {}, 0); }), "has volume 0 m^3");
  TetMesh nan = one_tet();
  nan.nodes(0, 0) = std::nan("");
  expect_contains(message_of([&] { SoftBody("b", nan, soft_material(), {}, 0); }), "has volume nan");
  TetMesh outside = one_tet();
  outside.tets(2, 0) = 4;
  expect_contains(message_of([&] { SoftBody("b", outside, soft_material(), {}, 0); }),
                  "element 0 refers to node 4 of 4");
}

TEST(SoftBody, RefusesABadMaterialNamingTheBody) {
  Material m = soft_material();
  m.poissons_ratio = 0.5;
  expect_contains(message_of([&] { SoftBody("liver", one_tet(), m, {}, 0); }),
                  "body \"liver\": poissons_ratio = 0.5 must lie in (-1, 0.5)");
  SoftBody body("liver", one_tet(), soft_material(), {}, 0);
  expect_contains(message_of([&] { body.set_materials({m}); }), "body \"liver\": poissons_ratio = 0.5");
}

TEST(SoftBody, RefusesAStateWithoutItsBlock) {
  const OneBody at(VecX::Zero(15), VecX::Zero(15));
  SoftBody body("b", one_tet(), soft_material(), {}, at.id);
  expect_contains(message_of([&] { body.energy(at.state.view()); }),
                  "is not a block of 4 nodes in this state");
  SoftBody lost("b", one_tet(), soft_material(), {}, 77);
  expect_contains(message_of([&] { lost.energy(at.state.view()); }), "block 77 is not a block of 4 nodes");
}
