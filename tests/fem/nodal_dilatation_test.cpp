#include "palpate/fem/nodal_dilatation.h"

#include <Eigen/Eigenvalues>

#include "core/polar.h"
#include "fem_fixture.h"

using namespace palpate;
using namespace palpate::fem;
using namespace palpate::fem::testing;

namespace {

Material nearly_incompressible(double stiffness_damping = 0.0) {
  Material m = soft_material();
  m.poissons_ratio = 0.49;
  m.stiffness_damping = stiffness_damping;
  return m;
}

SoftBodyOptions nodal(const Material& m, Tangent tangent = Tangent::kExact, bool full = false) {
  return {.tangent = tangent, .full_damping_tangent = full, .volumetric_share = kept_volumetric_share(m)};
}

/// Sheared and rotated, with every node perturbed; a large shake inverts elements.
struct Shaken {
  TetMesh rest;
  VecX x, v;
  explicit Shaken(unsigned seed, double shake = 0.06) : rest(jittered_cube(2, 0.12, seed)) {
    Random random(seed + 100);
    x = flat(random.rotation() * (Mat3::Identity() + 0.15 * random.matrix()) * rest.nodes) +
        shake * random.vector(3 * rest.nodes.cols());
    v = random.vector(x.size());
  }
};

VecX force(dynamics::ForceTerm& term, const VecX& x, const VecX& v) {
  OneBody at(x, v);
  VecX f = VecX::Zero(x.size());
  term.add_force(at.state.view(), f);
  return f;
}
double energy(dynamics::ForceTerm& term, const VecX& x) {
  const OneBody at(x, VecX::Zero(x.size()));
  return term.energy(at.state.view());
}
VecX apply(dynamics::ForceTerm& term, const VecX& x, const VecX& v, double k, double d, const VecX& w) {
  OneBody at(x, v);
  VecX y = VecX::Zero(x.size());
  term.apply_tangent(at.state.view(), k, d, w, y);
  return y;
}
MatX assembled(dynamics::ForceTerm& term, const VecX& x, const VecX& v, double k, double d) {
  OneBody at(x, v);
  dynamics::PatternBuilder builder(at.state.layout());
  term.add_pattern(builder);
  dynamics::BorderedMatrix A;
  A.body = builder.build();
  term.add_tangent(at.state.view(), k, d, A);
  return A.to_dense();
}

}  // namespace

TEST(NodalDilatation, KeptShareIsAllUpToNuOfAQuarterAndThenMuOfLambda) {
  Material m = soft_material();
  for (double nu : {-0.5, 0.0, 0.25}) {
    m.poissons_ratio = nu;
    EXPECT_DOUBLE_EQ(kept_volumetric_share(m), 1.0);
  }
  m.poissons_ratio = 0.4;  // lambda/mu = 2 nu/(1 - 2 nu) = 4
  EXPECT_NEAR(kept_volumetric_share(m), 0.25, 1e-15);
}

TEST(NodalDilatation, OneTetrahedronIsTheElement) {
  // All four nodes average over the single element: with the kept share it must equal the plain element,
  // whatever its shape.
  const TetMesh rest = one_tet();
  const Material m = nearly_incompressible(0.3);
  Random random(41);
  for (const auto& [name, stretches] : stretch_cases()) {
    const VecX x = flat(deformation(random, stretches) * rest.nodes), v = random.vector(12);
    SoftBody plain("b", rest, m, {.full_damping_tangent = true}, 0),
        kept("b", rest, m, nodal(m, Tangent::kExact, true), 0);
    NodalDilatation rest_of_it("b", rest, m, nodal(m, Tangent::kExact, true), 0);
    const VecX f = force(plain, x, v);
    EXPECT_LT((force(kept, x, v) + force(rest_of_it, x, v) - f).norm(), 1e-12 * f.norm()) << name;
    EXPECT_NEAR(energy(kept, x) + energy(rest_of_it, x), energy(plain, x), 1e-12 * energy(plain, x)) << name;
    const MatX K = assembled(plain, x, v, 1.0, 0.5);
    EXPECT_LT((assembled(kept, x, v, 1.0, 0.5) + assembled(rest_of_it, x, v, 1.0, 0.5) - K).norm(),
              1e-11 * K.norm())
        << name;
    const OneBody at(x, v);
    const double power = plain.dissipated_power(at.state.view());
    EXPECT_NEAR(kept.dissipated_power(at.state.view()) + rest_of_it.dissipated_power(at.state.view()), power,
                1e-12 * power)
        << name;
    const VecX stress = plain.nodal_stress(at.state.view());
    EXPECT_LT((rest_of_it.nodal_stress(at.state.view()) - stress).norm(), 1e-12 * stress.norm()) << name;
  }
}

TEST(NodalDilatation, UniformStrainIsThatOfTheElements) {
  Random random(42);
  const TetMesh rest = jittered_cube(3, 0.15, 43);
  const Material m = nearly_incompressible();
  const Mat3 A = random.rotation() * (Mat3::Identity() + 0.2 * random.matrix());
  const VecX x = flat(A * rest.nodes), zero = VecX::Zero(x.size());
  SoftBody plain("b", rest, m, {}, 0), kept("b", rest, m, nodal(m), 0);
  NodalDilatation averaged("b", rest, m, nodal(m), 0);
  const OneBody at(x, zero);
  const VecX theta = averaged.dilatations(at.state.view());
  EXPECT_LT((theta.array() - (polar_decomposition(A).S.trace() - 3.0)).abs().maxCoeff(), 1e-13);
  const VecX f = force(plain, x, zero);
  EXPECT_LT((force(kept, x, zero) + force(averaged, x, zero) - f).norm(), 1e-12 * f.norm());
  EXPECT_NEAR(energy(kept, x) + energy(averaged, x), energy(plain, x), 1e-12 * energy(plain, x));
}

TEST(NodalDilatation, ForceIsMinusTheGradientAndTheTangentItsDerivative) {
  for (double shake : {0.05, 0.35}) {  // 0.35 inverts about a third of the elements
    Shaken s(44, shake);
    const Material m = nearly_incompressible();
    NodalDilatation term("b", s.rest, m, nodal(m), 0);
    const VecX w = Random(45).vector(s.x.size()), zero = VecX::Zero(s.x.size());
    expect_slope_two([&](double h) { return VecX::Constant(1, energy(term, s.x + h * w)); },
                     VecX::Constant(1, -force(term, s.x, zero).dot(w)), 4e-4, "energy");
    expect_slope_two([&](double h) { return force(term, s.x + h * w, zero); },
                     -apply(term, s.x, zero, 1, 0, w), 4e-4, "force");
  }
}

TEST(NodalDilatation, FullDampingTangentIsTheDerivativeOfTheDampedForce) {
  Shaken s(46);
  const Material m = nearly_incompressible(0.4);
  NodalDilatation term("b", s.rest, m, nodal(m, Tangent::kExact, true), 0),
      symmetric("b", s.rest, m, nodal(m), 0);
  EXPECT_FALSE(term.traits().symmetric_tangent);
  EXPECT_TRUE(symmetric.traits().symmetric_tangent);
  const VecX w = Random(47).vector(s.x.size());
  expect_slope_two([&](double h) { return force(term, s.x + h * w, s.v); }, -apply(term, s.x, s.v, 1, 0, w),
                   2e-3, "by position");
  const VecX change = force(term, s.x, s.v + w) - force(term, s.x, s.v);
  EXPECT_LT((change + apply(term, s.x, s.v, 0, 1, w)).norm(), 1e-12 * change.norm());
}

TEST(NodalDilatation, AppliedEqualsAssembled) {
  Shaken s(48, 0.2);
  const Material m = nearly_incompressible(0.4);
  const VecX w = Random(49).vector(s.x.size());
  int compared = 0;
  for (Tangent tangent : {Tangent::kExact, Tangent::kProjected, Tangent::kWarped})
    for (bool full : {false, true})
      for (bool definite : {false, true}) {
        NodalDilatation term("b", s.rest, m, nodal(m, tangent, full), 0);
        term.project_to_psd(definite);
        const VecX expected = assembled(term, s.x, s.v, 0.7, 1.9) * w;
        EXPECT_LT((apply(term, s.x, s.v, 0.7, 1.9, w) - expected).norm(), 1e-13 * expected.norm());
        ++compared;
      }
  EXPECT_EQ(compared, 12);
}

TEST(NodalDilatation, SymmetricAndPositiveSemiDefiniteWhereAsked) {
  Shaken s(50, 0.3);
  s.x *= 0.8;  // compressed: the exact tangent is indefinite
  const Material m = nearly_incompressible();
  const auto smallest = [&](Tangent tangent, bool definite) {
    NodalDilatation term("b", s.rest, m, nodal(m, tangent), 0);
    term.project_to_psd(definite);
    const MatX A = assembled(term, s.x, s.v, 1, 0);
    EXPECT_LT((A - A.transpose()).norm(), 1e-14 * A.norm());
    return Eigen::SelfAdjointEigenSolver<MatX>(A).eigenvalues()[0] / A.norm();
  };
  EXPECT_LT(smallest(Tangent::kExact, false), -1e-3);
  EXPECT_GT(smallest(Tangent::kExact, true), -1e-13);
  EXPECT_GT(smallest(Tangent::kProjected, false), -1e-13);
  EXPECT_GT(smallest(Tangent::kWarped, false), -1e-13);
}

TEST(NodalDilatation, ExactTangentAtRestHasRankOneANode) {
  const TetMesh rest = jittered_cube(2, 0.12, 51);
  const Material m = nearly_incompressible();
  NodalDilatation term("b", rest, m, nodal(m), 0);
  const VecX x = flat(rest.nodes);
  const VecX values =
      Eigen::SelfAdjointEigenSolver<MatX>(assembled(term, x, VecX::Zero(x.size()), 1, 0)).eigenvalues();
  EXPECT_LE((values.array() > 1e-12 * values.maxCoeff()).count(), rest.nodes.cols());
}

TEST(NodalDilatation, NoResultantNoMomentNoBrakeOnARigidMotion) {
  Shaken s(52, 0.2);
  const Material m = nearly_incompressible(0.5);
  NodalDilatation term("b", s.rest, m, nodal(m), 0);
  const Points x = unflat(s.x);
  expect_balanced(unflat(force(term, s.x, s.v)), x);
  const VecX rigid = flat((cross_matrix(Vec3(1, -2, 3)) * x).colwise() + Vec3(4, 5, 6));
  const OneBody moving(s.x, s.v), spinning(s.x, rigid);
  EXPECT_LT(term.dissipated_power(spinning.state.view()), 1e-12 * term.dissipated_power(moving.state.view()));
  NodalDilatation elastic("b", s.rest, nearly_incompressible(), nodal(nearly_incompressible()), 0);
  EXPECT_NEAR(-(force(term, s.x, s.v) - force(elastic, s.x, s.v)).dot(s.v),
              term.dissipated_power(moving.state.view()), 1e-12 * term.dissipated_power(moving.state.view()));
}

TEST(NodalDilatation, TurnsWithTheBody) {
  Shaken s(53, 0.2);
  const Material m = nearly_incompressible(0.5);
  NodalDilatation term("b", s.rest, m, nodal(m), 0);
  const Mat3 Q = Random(54).rotation();
  const VecX x = flat((Q * unflat(s.x)).colwise() + Vec3(0.3, -2.0, 1.1)), v = flat(Q * unflat(s.v)),
             expected = flat(Q * unflat(force(term, s.x, s.v)));
  EXPECT_NEAR(energy(term, x), energy(term, s.x), 1e-12 * energy(term, s.x));
  EXPECT_LT((force(term, x, v) - expected).norm(), 1e-12 * expected.norm());
}

TEST(NodalDilatation, SecondBlockOfAStateAndAChangedPattern) {
  const Shaken s(55);
  const Material m = nearly_incompressible();
  const auto n = s.x.size();
  dynamics::State state(static_cast<int>(12 + n), static_cast<int>(12 + n));
  dynamics::BlockSpec spec;
  spec.q_size = spec.u_size = 12;
  state.insert(spec, VecX::Zero(12), VecX::Zero(12));
  spec.q_size = spec.u_size = static_cast<int>(n);
  const int id = state.insert(spec, s.x, s.v);
  NodalDilatation term("b", s.rest, m, nodal(m), id), alone("b", s.rest, m, nodal(m), 0);
  const MatX expected = assembled(alone, s.x, s.v, 1, 0);
  for (int extra : {0, 1}) {
    dynamics::PatternBuilder builder(state.layout());
    term.add_pattern(builder);
    if (extra) builder.add_pair(0, 9);
    dynamics::BorderedMatrix A;
    A.body = builder.build();
    term.add_tangent(state.view(), 1, 0, A);
    const MatX dense = A.to_dense();
    EXPECT_EQ((dense.bottomRightCorner(n, n) - expected).norm(), 0.0);
    EXPECT_EQ(dense.topRows(12).norm(), 0.0);
  }
}

TEST(NodalDilatation, RefusesABadMaterialNamingTheBody) {
  Material m = soft_material();
  m.poissons_ratio = 0.5;
  expect_contains(message_of([&] { NodalDilatation("liver", one_tet(), m, {}, 0); }),
                  "body \"liver\": poissons_ratio = 0.5 must lie in (-1, 0.5)");
}
