#include <Eigen/Eigenvalues>

#include "fem_fixture.h"

using namespace palpate;
using namespace palpate::fem;
using namespace palpate::fem::testing;

namespace {

/// A body sheared, rotated and moving, with every node perturbed; a large shake inverts elements.
struct Moving {
  TetMesh rest;
  VecX x, v;
  explicit Moving(unsigned seed, double shake = 0.06) : rest(jittered_cube(2, 0.12, seed)) {
    Random random(seed + 100);
    const Mat3 A = random.rotation() * (Mat3::Identity() + 0.15 * random.matrix());
    x = flat(A * rest.nodes) + shake * random.vector(3 * rest.nodes.cols());
    v = random.vector(x.size());
  }
};

VecX force(SoftBody& body, const VecX& x, const VecX& v) {
  OneBody at(x, v);
  VecX f = VecX::Zero(x.size());
  body.add_force(at.state.view(), f);
  return f;
}
double energy(SoftBody& body, const VecX& x) {
  const OneBody at(x, VecX::Zero(x.size()));
  return body.energy(at.state.view());
}

VecX apply(SoftBody& body, const VecX& x, const VecX& v, double k, double d, const VecX& w) {
  OneBody at(x, v);
  VecX y = VecX::Zero(x.size());
  body.apply_tangent(at.state.view(), k, d, w, y);
  return y;
}

MatX assembled(SoftBody& body, const VecX& x, const VecX& v, double k, double d) {
  OneBody at(x, v);
  dynamics::PatternBuilder builder(at.state.layout());
  body.add_pattern(builder);
  dynamics::BorderedMatrix A;
  A.body = builder.build();
  body.add_tangent(at.state.view(), k, d, A);
  return A.to_dense();
}

Material damped() {
  Material m = soft_material();
  m.stiffness_damping = 0.4;
  m.mass_damping = 0.3;
  return m;
}

}  // namespace

TEST(Tangent, ForceIsMinusTheGradientOfTheEnergy) {
  for (double shake : {0.05, 0.35}) {  // 0.35 inverts about a third of the elements
    Moving m(3, shake);
    SoftBody body("b", m.rest, soft_material(), {}, 0);
    const VecX w = Random(7).vector(m.x.size());
    const VecX f = force(body, m.x, VecX::Zero(m.x.size()));
    if (shake > 0.1) { EXPECT_GT(body.counts().inverted, 3); }
    expect_slope_two([&](double h) { return VecX::Constant(1, energy(body, m.x + h * w)); },
                     VecX::Constant(1, -f.dot(w)), 4e-4, "energy");
  }
}

TEST(Tangent, ExactTangentIsTheDerivativeOfTheForce) {
  for (double shake : {0.05, 0.35}) {
    Moving m(4, shake);
    const VecX zero = VecX::Zero(m.x.size()), w = Random(8).vector(m.x.size());
    SoftBody body("b", m.rest, soft_material(), {}, 0);
    expect_slope_two([&](double h) { return force(body, m.x + h * w, zero); },
                     -apply(body, m.x, zero, 1, 0, w), 4e-4, "force");
    if (shake > 0.1) { EXPECT_GT(body.counts().inverted, 3); }
  }
}

TEST(Tangent, OneElementInEveryShape) {
  const TetMesh rest = one_tet();
  Random random(11);
  for (const auto& [name, stretches] : stretch_cases()) {
    const VecX x = flat(deformation(random, stretches) * rest.nodes), zero = VecX::Zero(12),
               w = random.vector(12);
    SoftBody body("b", rest, soft_material(), {}, 0);
    expect_slope_two([&](double h) { return VecX::Constant(1, energy(body, x + h * w)); },
                     VecX::Constant(1, -force(body, x, zero).dot(w)), 1e-2, name);
    expect_slope_two([&](double h) { return force(body, x + h * w, zero); }, -apply(body, x, zero, 1, 0, w),
                     1e-2, name);
  }
}

TEST(Tangent, FullDampingTangentIsTheDerivativeOfTheDampedForce) {
  Moving m(5);
  SoftBody body("b", m.rest, damped(), {.tangent = Tangent::kExact, .full_damping_tangent = true}, 0);
  EXPECT_FALSE(body.traits().symmetric_tangent);
  const VecX w = Random(9).vector(m.x.size());
  expect_slope_two([&](double h) { return force(body, m.x + h * w, m.v); }, -apply(body, m.x, m.v, 1, 0, w),
                   2e-3, "by position");
  // The damping force is linear in the velocity: its derivative is exact.
  const VecX change = force(body, m.x, m.v + w) - force(body, m.x, m.v);
  EXPECT_LT((change + apply(body, m.x, m.v, 0, 1, w)).norm(), 1e-12 * change.norm());
}

TEST(Tangent, DampingByPositionIsDroppedByDefault) {
  Moving m(5);
  SoftBody dropped("b", m.rest, damped(), {}, 0), elastic("b", m.rest, soft_material(), {}, 0);
  EXPECT_TRUE(dropped.traits().symmetric_tangent);
  EXPECT_EQ((assembled(dropped, m.x, m.v, 1, 0) - assembled(elastic, m.x, m.v, 1, 0)).norm(), 0.0);
}

TEST(Tangent, AppliedEqualsAssembled) {
  Moving m(6, 0.2);
  const VecX w = Random(10).vector(m.x.size());
  int compared = 0;
  for (Tangent tangent : {Tangent::kExact, Tangent::kProjected, Tangent::kWarped})
    for (bool full : {false, true}) {
      SoftBody body("b", m.rest, damped(), {.tangent = tangent, .full_damping_tangent = full}, 0);
      const VecX expected = assembled(body, m.x, m.v, 0.7, 1.9) * w;
      EXPECT_LT((apply(body, m.x, m.v, 0.7, 1.9, w) - expected).norm(), 1e-13 * expected.norm());
      ++compared;
    }
  EXPECT_EQ(compared, 6);
}

TEST(Tangent, SymmetricToRounding) {
  Moving m(7, 0.3);
  for (Tangent tangent : {Tangent::kExact, Tangent::kProjected, Tangent::kWarped}) {
    SoftBody body("b", m.rest, damped(), {.tangent = tangent}, 0);
    const MatX A = assembled(body, m.x, m.v, 1.0, 0.5);
    EXPECT_LT((A - A.transpose()).norm(), 1e-14 * A.norm());
  }
}

TEST(Tangent, ProjectedIsPositiveSemiDefiniteWhereExactIsNot) {
  Moving m(8, 0.3);
  const auto smallest = [&](Tangent tangent) {
    SoftBody body("b", m.rest, soft_material(), {.tangent = tangent}, 0);
    const MatX A = assembled(body, m.x, m.v, 1, 0);
    return Eigen::SelfAdjointEigenSolver<MatX>(A).eigenvalues()[0] / A.norm();
  };
  EXPECT_LT(smallest(Tangent::kExact), -1e-3);
  EXPECT_GT(smallest(Tangent::kProjected), -1e-13);
  EXPECT_GT(smallest(Tangent::kWarped), -1e-13);
}

TEST(Tangent, WarpedEqualsExactAtARotatedRestShape) {
  const TetMesh rest = jittered_cube(2, 0.1, 9);
  const VecX x = flat(Random(12).rotation() * rest.nodes), zero = VecX::Zero(x.size());
  SoftBody exact("b", rest, soft_material(), {}, 0),
      warped("b", rest, soft_material(), {.tangent = Tangent::kWarped}, 0);
  const MatX K = assembled(exact, x, zero, 1, 0);
  EXPECT_LT((assembled(warped, x, zero, 1, 0) - K).norm(), 1e-12 * K.norm());
}

TEST(Tangent, ClampingIsCounted) {
  const TetMesh rest = one_tet();
  SoftBody body("b", rest, soft_material(), {}, 0);
  const VecX x = VecX::Zero(12);  // a point: all stretches zero
  EXPECT_TRUE(assembled(body, x, x, 1, 0).allFinite());
  EXPECT_EQ(body.counts().clamped, 1);
  body.reset_counts();
  EXPECT_EQ(body.counts().clamped, 0);
}

TEST(Tangent, ScatterMapFollowsAChangedPattern) {
  // The body's matrix in a larger pattern, and back: cached slots must not be stale.
  const TetMesh rest = jittered_cube(1, 0.1, 10);
  const VecX x = flat(rest.nodes);
  SoftBody body("b", rest, soft_material(), {}, 0);
  OneBody at(x, VecX::Zero(x.size()));
  dynamics::PatternBuilder narrow(at.state.layout()), wide(at.state.layout());
  body.add_pattern(narrow);
  body.add_pattern(wide);
  for (int i = 1; i < 8; ++i) wide.add_pair(0, i);
  dynamics::BorderedMatrix A, B;
  A.body = narrow.build();
  B.body = wide.build();
  body.add_tangent(at.state.view(), 1, 0, A);
  body.add_tangent(at.state.view(), 1, 0, B);
  EXPECT_EQ((A.to_dense() - B.to_dense()).norm(), 0.0);
  A.set_zero();
  body.add_tangent(at.state.view(), 1, 0, A);
  EXPECT_EQ((A.to_dense() - B.to_dense()).norm(), 0.0);
}
