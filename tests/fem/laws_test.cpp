#include <array>

#include <Eigen/Eigenvalues>

#include "law_reference.h"
#include "palpate/core/workers.h"
#include "palpate/dynamics/zero_row_sum_matrix.h"
#include "palpate/fem/nodal_dilatation.h"

// Conformance suite of the constitutive laws, over the whole registry: a new law is tested by being listed.

using namespace palpate;
using namespace palpate::fem;
using namespace palpate::fem::testing;
using Mat9 = Eigen::Matrix<double, 9, 9>;

namespace {

const Lame kLame{1.1, 2.3};

class Laws : public ::testing::TestWithParam<std::string> {
 protected:
  const Law& law() const { return law_called(GetParam()); }
  std::vector<Tangent> tangents() const {
    if (law().warped) return {Tangent::kExact, Tangent::kProjected, Tangent::kWarped};
    return {Tangent::kExact, Tangent::kProjected};
  }
  SoftBodyOptions with(Tangent tangent, bool full = false, const std::string& instructions = {}) const {
    SoftBodyOptions out = options(tangent, full, instructions);
    out.law = GetParam();
    return out;
  }
  /// dP/dF, one column per unit direction.
  Mat9 hessian(const Mat3& F, Tangent tangent, const Lame& lame = kLame) const {
    Mat9 H;
    for (int i = 0; i < 9; ++i) {
      Mat3 dF = Mat3::Zero();
      dF(i % 3, i / 3) = 1.0;
      H.col(i) = law().stress_change(tangent, F, dF, lame).reshaped();
    }
    return H;
  }
};

Mat9 numeric_projection(const Mat9& H) {
  const Eigen::SelfAdjointEigenSolver<Mat9> eigen(0.5 * (H + H.transpose()));
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() *
         eigen.eigenvectors().transpose();
}

/// Deformations of every kind except the corotational law's singular set, one element each.
std::vector<Mat3> shapes(Random& random) {
  std::vector<Mat3> out;
  for (int i = 0; i < 40; ++i)
    for (const Vec3& s : {Vec3(Vec3(1.3, 1.0, 0.8) + 0.25 * Vec3(random.vector(3))),
                          Vec3(1.2 + 0.3 * random(), 0.8 + 0.2 * random(), 0.0),
                          Vec3(1.2 + 0.2 * random(), 0.8 + 0.1 * random(), -0.35 + 0.3 * random()),
                          Vec3(4.0 + random(), 2.0 + 0.9 * random(), 0.5 + 0.4 * random()),
                          Vec3(Vec3(0.05, 0.03, 0.01) * (1.0 + 0.1 * random()))})
      out.push_back(deformation(random, s));
  return out;
}

struct Shaken {
  TetMesh rest;
  VecX x, v, w;
  Shaken(int cells, double shake, unsigned seed) : rest(jittered_cube(cells, 0.15, seed)) {
    Random random(seed + 1);
    x = flat(random.rotation() * rest.nodes) + shake * random.vector(3 * rest.nodes.cols());
    v = random.vector(x.size());
    w = random.vector(x.size());
  }
};

VecX force(SoftBody& body, const VecX& x, const VecX& v) {
  OneBody at(x, v);
  VecX f = VecX::Zero(x.size());
  body.add_force(at.state.view(), f);
  return f;
}

}  // namespace

TEST_P(Laws, StressIsTheDerivativeOfTheEnergyInEveryShape) {
  Random random(1);
  for (const auto& [name, stretches] : stretch_cases()) {
    const Mat3 F = deformation(random, stretches), dF = random.matrix();
    expect_slope_two([&](double h) { return VecX::Constant(1, law().energy_density(F + h * dF, kLame)); },
                     VecX::Constant(1, law().stress(F, kLame).cwiseProduct(dF).sum()), 1e-2, name);
  }
}

TEST_P(Laws, ExactTangentIsTheDerivativeOfTheStressInEveryShape) {
  Random random(2);
  for (const auto& [name, stretches] : stretch_cases()) {
    const Mat3 F = deformation(random, stretches), dF = random.matrix();
    expect_slope_two([&](double h) -> VecX { return law().stress(F + h * dF, kLame).reshaped(); },
                     law().stress_change(Tangent::kExact, F, dF, kLame).reshaped(), 1e-2, name);
  }
}

TEST_P(Laws, ProjectedTangentIsTheNearestSemiDefiniteOne) {
  Random random(4);
  int changed = 0, kept = 0;
  for (int i = 0; i < 300; ++i) {
    // from compressed and inverted to slightly stretched in every direction
    const Vec3 stretches = i < 200 ? Vec3(Vec3(1.6, 1.2, 0.3) + 0.5 * Vec3(random.vector(3)))
                                   : Vec3(Vec3(1.1, 1.08, 1.06) + 0.05 * Vec3(random.vector(3)));
    const Mat3 F = deformation(random, stretches);
    const Mat9 exact = hessian(F, Tangent::kExact), projected = hessian(F, Tangent::kProjected);
    EXPECT_LT((exact - exact.transpose()).norm(), 1e-13 * exact.norm());
    EXPECT_LT((projected - numeric_projection(exact)).norm(), 1e-10 * exact.norm());
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Mat9>(projected).eigenvalues()[0], -1e-12 * exact.norm());
    ((projected - exact).norm() > 1e-6 ? changed : kept) += 1;
  }
  EXPECT_GT(changed, 50);  // both branches were taken
  EXPECT_GT(kept, 50);
}

TEST_P(Laws, RestIsFreeOfStressAndARotationChangesNothing) {
  Random random(5);
  for (int i = 0; i < 20; ++i) {
    const Mat3 Q = random.rotation(),
               F = deformation(random, stretch_cases()[static_cast<std::size_t>(i % 4)].second);
    EXPECT_NEAR(law().energy_density(Q, kLame), 0.0, 1e-14);
    EXPECT_LT(law().stress(Q, kLame).norm(), 1e-13);
    const double energy = law().energy_density(F, kLame);
    const Mat3 P = law().stress(F, kLame);
    EXPECT_NEAR(law().energy_density(Q * F, kLame), energy, 1e-12 * energy);
    EXPECT_NEAR(law().energy_density(F * Q, kLame), energy, 1e-12 * energy);
    EXPECT_LT((law().stress(Q * F, kLame) - Q * P).norm(), 1e-12 * P.norm());
    EXPECT_LT((law().stress(F * Q, kLame) - P * Q).norm(), 1e-12 * P.norm());
    const Mat3 kirchhoff = P * F.transpose();  // symmetric: no moment
    EXPECT_LT((kirchhoff - kirchhoff.transpose()).norm(), 1e-12 * P.norm() * F.norm());
    EXPECT_GT(energy, 0.0);
  }
}

TEST_P(Laws, SmallStrainIsLinearElasticity) {
  Random random(6);
  for (const double poisson : {-0.9, -0.3, 0.0, 0.3, 0.45, 0.499}) {
    const Material m{.youngs_modulus = 3.0, .poissons_ratio = poisson};
    const Lame lame{m.mu(), m.lambda()};
    for (const Tangent tangent : tangents()) {
      const Mat3 Q = random.rotation(), A = random.matrix(), strain = 0.5 * (A + A.transpose());
      const Mat3 linear = 2.0 * lame.mu * strain + lame.lambda * strain.trace() * Mat3::Identity();
      EXPECT_LT((law().stress_change(tangent, Q, Q * A, lame) - Q * linear).norm(), 1e-12 * linear.norm())
          << "Poisson's ratio " << poisson;
    }
  }
}

TEST_P(Laws, LanesGiveWhatTheScalarFormulasGiveInEveryShape) {
  Random random(81);
  const Apart m(shapes(random), random);
  for (const std::string& instructions : instruction_sets())
    for (const Tangent tangent : tangents())
      for (const bool full : {false, true}) {
        const Evaluation found =
            evaluate(m.rest, damped_material(), with(tangent, full, instructions), m.x, m.v, m.w, true);
        const Reference expected = reference(law(), m.rest, damped_material(), tangent, full, m.x, m.v, m.w);
        const VecX product = found.A * m.w;
        for (Eigen::Index e = 0; e < m.rest.tets.cols(); ++e) {
          EXPECT_LT(apart(found.f.segment<12>(12 * e), expected.f.segment<12>(12 * e)), 1e-12)
              << instructions << ", element " << e;
          EXPECT_LT(apart(found.y.segment<12>(12 * e), expected.y.segment<12>(12 * e)), 1e-11)
              << instructions << ", element " << e;
          EXPECT_LT(apart(product.segment<12>(12 * e), expected.y.segment<12>(12 * e)), 1e-11)
              << instructions << ", element " << e;
        }
        EXPECT_NEAR(found.energy, expected.energy, 1e-13 * expected.energy);
        EXPECT_NEAR(found.power, expected.power, 1e-13 * expected.power);
        EXPECT_GE(found.counts.inverted, 40);
        EXPECT_LE(found.counts.inverted, 80);  // flat elements: the sign is decided by rounding
        if (tangent == Tangent::kProjected) { EXPECT_GT(found.counts.by_scalar, 40); }
        if (tangent == Tangent::kProjected) { EXPECT_LT(found.counts.by_scalar, m.rest.tets.cols()); }
      }
}

TEST_P(Laws, ForceAndTangentOfABodyAreTheDerivativesOfItsEnergy) {
  for (const double shake : {0.05, 0.35}) {  // 0.35 inverts about a third of the elements
    const Shaken m(2, shake, 3);
    const VecX still = VecX::Zero(m.x.size());
    SoftBody body("b", m.rest, soft_material(), with(Tangent::kExact), 0);
    const auto energy = [&](double h) {
      const OneBody at(m.x + h * m.w, still);
      return VecX::Constant(1, body.energy(at.state.view()));
    };
    const VecX f = force(body, m.x, still);
    expect_slope_two(energy, VecX::Constant(1, -f.dot(m.w)), 4e-4, "energy");
    OneBody at(m.x, still);
    VecX product = still;
    body.apply_tangent(at.state.view(), 1.0, 0.0, m.w, product);
    expect_slope_two([&](double h) { return force(body, m.x + h * m.w, still); }, -product, 4e-4, "force");
    expect_balanced(unflat(f), unflat(m.x));
    if (shake > 0.1) { EXPECT_GT(body.counts().inverted, 3); }
  }
}

// Patch test: under a uniform deformation of an irregular mesh, inner nodes have no force, and the outer
// nodes balance the law's stress: sum of f_i X_i^T = -P volume.
TEST_P(Laws, PatchOfUniformDeformation) {
  Random random(61);
  const TetMesh rest = jittered_cube(4, 0.15, 62);
  const Material m = soft_material();
  for (const auto& [name, stretches] : stretch_cases()) {
    const Mat3 A = deformation(random, stretches);
    const VecX x = flat(A * rest.nodes);
    SoftBody body("b", rest, m, with(Tangent::kExact), 0);
    const Points f = unflat(force(body, x, VecX::Zero(x.size())));
    double volume = 0.0, inside = 0.0;
    for (const auto& tet : rest.tets.colwise()) {
      Mat3 edges;
      for (int a = 0; a < 3; ++a) edges.col(a) = rest.nodes.col(tet[a + 1]) - rest.nodes.col(tet[0]);
      volume += edges.determinant() / 6.0;
    }
    int counted = 0;
    for (int i = 1; i < 4; ++i)
      for (int j = 1; j < 4; ++j)
        for (int k = 1; k < 4; ++k, ++counted) inside = std::max(inside, f.col((i * 5 + j) * 5 + k).norm());
    EXPECT_EQ(counted, 27);
    const Mat3 P = law().stress(A, {m.mu(), m.lambda()});
    EXPECT_LT(inside, 1e-13 * P.norm()) << name;
    EXPECT_LT((f * rest.nodes.transpose() + volume * P).norm(), 1e-12 * P.norm()) << name;
  }
}

TEST_P(Laws, DampingIsTheSameForAll) {
  const Shaken m(3, 0.1, 21);
  const auto damping = [&](const std::string& name) {
    SoftBody damped("b", m.rest, damped_material(), {.law = name}, 0),
        elastic("b", m.rest, soft_material(), {.law = name}, 0);
    return VecX(force(damped, m.x, m.v) - force(elastic, m.x, m.v));
  };
  EXPECT_LT(apart(damping(GetParam()), damping("corotational")), 1e-13);
}

// Fused assembly of a linearly implicit step equals separate evaluations of force, product and tangent.
TEST_P(Laws, FusedStepIsForceProductAndTangent) {
  const Shaken m(10, 0.03, 31);  // several chunks
  Material material = soft_material();
  material.stiffness_damping = 0.4;
  for (const Tangent tangent : tangents()) {
    std::vector<VecX> forces;
    std::vector<std::vector<float>> blocks;
    for (const int threads : {1, 3}) {
      workers::set_count(threads);
      OneBody at(m.x, m.v);
      SoftBody body("b", m.rest, material, with(tangent), at.id);
      dynamics::PatternBuilder builder(at.state.layout());
      body.add_pattern(builder);
      dynamics::BorderedMatrix whole;
      whole.body = builder.build();
      dynamics::ZeroRowSumMatrix A;
      A.pattern = &whole.body;
      A.slot_map.assign(static_cast<std::size_t>(whole.body.slot_count()), -1);
      int pairs = 0;
      const auto each_pair = [&](auto&& work) {  // i < j
        for (int i = 0; i < whole.body.block_rows(); ++i)
          for (int s = whole.body.row_start()[static_cast<std::size_t>(i)];
               s < whole.body.row_start()[static_cast<std::size_t>(i) + 1]; ++s)
            if (const int j = whole.body.columns()[static_cast<std::size_t>(s)]; i < j) work(i, j, s);
      };
      each_pair([&](int i, int j, int s) {
        A.slot_map[static_cast<std::size_t>(s)] =
            A.slot_map[static_cast<std::size_t>(whole.body.slot(j, i))] = pairs++;
      });
      A.values.assign(9 * static_cast<std::size_t>(pairs), 0.0f);
      A.diagonal = VecX::Zero(m.x.size());
      A.slot_map_key = 1;
      VecX f = VecX::Zero(m.x.size()), want = f, product = f, split = f;
      body.add_step(at.state.view(), m.w, 0.7, 1.3, f, A);
      body.add_step_force(at.state.view(), m.w, VecX::Zero(m.x.size()), split);
      body.add_force(at.state.view(), want);
      body.apply_tangent(at.state.view(), 1.0, 0.0, m.w, product);
      EXPECT_LT(apart(f, want - product), 1e-12);
      EXPECT_LT(apart(split, want - product), 1e-12);
      body.add_tangent(at.state.view(), 0.7, 1.3, whole);
      double largest = 0.0;
      for (const double value : whole.body.values()) largest = std::max(largest, std::abs(value));
      each_pair([&](int, int, int s) {
        const Mat3 stored = Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(
                                A.values.data() + 9 * A.slot_map[static_cast<std::size_t>(s)])
                                .cast<double>();
        const Mat3 exact =
            Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(whole.body.block(s));
        EXPECT_LT((stored - exact).norm(), 1e-7 * exact.norm() + 1e-12 * largest) << "block " << s;
      });
      EXPECT_GT(pairs, 5000);
      forces.push_back(f);
      blocks.push_back(A.values);
    }
    EXPECT_EQ(forces[0], forces[1]);
    EXPECT_EQ(blocks[0], blocks[1]);
  }
  workers::set_count(1);
}

TEST_P(Laws, ABodyAskedForADefiniteTangentGivesTheProjectedOne) {
  const Shaken m(2, 0.2, 33);
  SoftBody exact("b", m.rest, damped_material(), with(Tangent::kExact, true), 0),
      projected("b", m.rest, damped_material(), with(Tangent::kProjected), 0);
  const auto product = [&](SoftBody& body) {
    OneBody at(m.x, m.v);
    VecX y = VecX::Zero(m.x.size());
    body.apply_tangent(at.state.view(), 1.0, 0.5, m.w, y);
    return y;
  };
  const VecX before = product(exact);
  exact.project_to_psd(true);
  EXPECT_EQ(product(exact), product(projected));
  EXPECT_GT(apart(product(exact), before), 1e-3);
  exact.project_to_psd(false);
  EXPECT_EQ(product(exact), before);
}

TEST_P(Laws, StressOfAPictureIsThatOfTheLaw) {
  const TetMesh rest = jittered_cube(2, 0.1, 34);
  const Material m = soft_material();
  const Mat3 F = Vec3(1.2, 0.9, 1.05).asDiagonal();
  const OneBody at(flat(F * rest.nodes), VecX::Zero(3 * rest.nodes.cols()));
  SoftBody body("b", rest, m, with(Tangent::kExact), at.id);
  const Mat3 cauchy = law().stress(F, {m.mu(), m.lambda()}) * F.transpose() / F.determinant();
  const double a = cauchy(0, 0) - cauchy(1, 1), b = cauchy(1, 1) - cauchy(2, 2),
               c = cauchy(2, 2) - cauchy(0, 0);
  const double expected = std::sqrt(0.5 * (a * a + b * b + c * c));
  EXPECT_LT((body.nodal_stress(at.state.view()).array() - expected).abs().maxCoeff(), 1e-12 * expected);
}

TEST_P(Laws, NotANumberStaysWhereItIs) {
  Shaken m(2, 0.02, 91);
  m.x[0] = std::nan("");
  for (const Tangent tangent : tangents()) {
    const Evaluation found = evaluate(m.rest, damped_material(), with(tangent), m.x, m.v, m.w, false);
    EXPECT_TRUE(std::isnan(found.f[0]));
    EXPECT_TRUE(std::isnan(found.y[0]));
    // the node at the opposite corner shares no element with it
    EXPECT_TRUE(found.f.tail<3>().allFinite());
    EXPECT_TRUE(found.y.tail<3>().allFinite());
  }
}

TEST_P(Laws, WhatALawDoesNotHaveIsRefusedWithTheWayOut) {
  const auto make = [&](const SoftBodyOptions& options) {
    return message_of([&] { SoftBody("liver", one_tet(), soft_material(), options, 0); });
  };
  const std::string warped = make(with(Tangent::kWarped));
  if (law().warped)
    EXPECT_EQ(warped, "");
  else
    expect_contains(warped, fmt::format("body \"liver\": tangent = \"warped\" is not available for law = "
                                        "\"{}\"; use \"exact\" or \"projected\"",
                                        GetParam()));
  SoftBodyOptions split = with(Tangent::kExact), by_material = split;
  split.volumetric_share = 0.5;
  by_material.volumetric_shares = {0.5};
  for (const SoftBodyOptions& options : {split, by_material})
    if (law().nodal_dilatation)
      EXPECT_EQ(make(options), "");
    else
      expect_contains(make(options), "volumetric = \"nodal\" is not available for law");
  const std::string nodal =
      message_of([&] { NodalDilatation("liver", one_tet(), soft_material(), split, 0); });
  EXPECT_EQ(nodal.empty(), law().nodal_dilatation) << nodal;
}

INSTANTIATE_TEST_SUITE_P(Registry, Laws, ::testing::ValuesIn(names(law_registry())),
                         [](const auto& named) { return named.param; });

TEST(LawRegistry, NamesTheLawsAndRefusesOthersByTheNearest) {
  EXPECT_EQ(names(law_registry()), (std::vector<std::string>{"corotational", "stable_neo_hookean"}));
  for (const auto& entry : law_registry()) EXPECT_FALSE(entry.summary.empty());
  const auto make = [&](const std::string& name) {
    return message_of([&] { SoftBody("liver", one_tet(), soft_material(), {.law = name}, 0); });
  };
  expect_contains(
      make("stable-neo-hookean"),
      "body \"liver\": unknown law \"stable-neo-hookean\" (did you mean \"stable_neo_hookean\"?)");
  expect_contains(make("ogden"), "(known: corotational, stable_neo_hookean)");
}
