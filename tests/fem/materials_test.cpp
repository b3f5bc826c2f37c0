#include "fem_fixture.h"
#include "palpate/core/workers.h"
#include "palpate/dynamics/zero_row_sum_matrix.h"
#include "palpate/fem/nodal_dilatation.h"

// Bodies with several materials. Except for shared nodes, everything is a sum over elements: a body with two
// materials is the sum of two bodies on the same nodes, each with the elements of one material. Bodies with
// one material therefore verify all results of the mixed body.

using namespace palpate;
using namespace palpate::fem;
using namespace palpate::fem::testing;

namespace {

Material soft() {
  Material m = soft_material();
  m.mass_damping = 0.3;
  return m;
}
Material stiff() {
  return {.youngs_modulus = 9e3,
          .poissons_ratio = 0.2,
          .density = 7.0,
          .mass_damping = 0.0,
          .stiffness_damping = 0.02};
}
Material rubber() {
  return {.youngs_modulus = 40.0,
          .poissons_ratio = 0.49,
          .density = 1.5,
          .mass_damping = 0.8,
          .stiffness_damping = 0.4};
}

/// A deformed cube whose elements have three materials in no particular order.
struct Mixed {
  TetMesh rest;
  Materials materials{{soft(), stiff(), rubber()}, {}};
  VecX x, v, w;
  explicit Mixed(int cells, double shake = 0.05, unsigned seed = 51)
      : rest(jittered_cube(cells, 0.12, seed)) {
    Random random(seed + 1);
    for (Eigen::Index e = 0; e < rest.tets.cols(); ++e)
      materials.of_element.push_back(static_cast<int>(1.5 * (random() + 1.0)));
    x = flat(random.rotation() * (Mat3::Identity() + 0.1 * random.matrix()) * rest.nodes) +
        shake / cells * random.vector(3 * rest.nodes.cols());
    v = random.vector(x.size());
    w = random.vector(x.size());
  }
  /// Mesh of the elements with one material, on all nodes.
  TetMesh part(int material) const {
    TetMesh out{rest.nodes, Tets(4, rest.tets.cols())};
    Eigen::Index count = 0;
    for (Eigen::Index e = 0; e < rest.tets.cols(); ++e)
      if (materials.of_element[static_cast<std::size_t>(e)] == material)
        out.tets.col(count++) = rest.tets.col(e);
    out.tets.conservativeResize(4, count);
    return out;
  }
};

/// Results of a term at one state.
struct Figures {
  VecX force, product;
  MatX tangent;
  double energy = 0.0, power = 0.0;
};

Figures evaluate(dynamics::ForceTerm& term, const dynamics::ForceTerm& pattern_of, const Mixed& m,
                 bool dense = true) {
  OneBody at(m.x, m.v);
  const dynamics::StateView view = at.state.view();
  Figures out;
  out.force = out.product = VecX::Zero(m.x.size());
  term.add_force(view, out.force);
  term.apply_tangent(view, 0.7, 1.3, m.w, out.product);
  out.energy = term.energy(view);
  out.power = term.dissipated_power(view);
  if (!dense) return out;
  dynamics::PatternBuilder builder(at.state.layout());
  pattern_of.add_pattern(builder);
  dynamics::BorderedMatrix A;
  A.body = builder.build();
  term.add_tangent(view, 0.7, 1.3, A);
  out.tangent = A.to_dense();
  return out;
}

void expect_sum(const Figures& whole, const std::vector<Figures>& parts, const std::string& what) {
  Figures sum = parts[0];
  for (std::size_t i = 1; i < parts.size(); ++i) {
    sum.force += parts[i].force;
    sum.product += parts[i].product;
    sum.tangent += parts[i].tangent;
    sum.energy += parts[i].energy;
    sum.power += parts[i].power;
    EXPECT_GT(parts[i].force.norm(), 1e-6 * sum.force.norm()) << what << ": the part counts";
  }
  EXPECT_LT((whole.force - sum.force).norm(), 1e-13 * sum.force.norm()) << what;
  EXPECT_LT((whole.product - sum.product).norm(), 1e-13 * sum.product.norm()) << what;
  EXPECT_LT((whole.tangent - sum.tangent).norm(), 1e-13 * sum.tangent.norm()) << what;
  EXPECT_NEAR(whole.energy, sum.energy, 1e-13 * sum.energy) << what;
  EXPECT_NEAR(whole.power, sum.power, 1e-13 * sum.power) << what;
}

VecX force(dynamics::ForceTerm& term, const VecX& x, const VecX& v) {
  OneBody at(x, v);
  VecX f = VecX::Zero(x.size());
  term.add_force(at.state.view(), f);
  return f;
}

}  // namespace

TEST(Materials, ABodyOfThreeIsTheSumOfTheThree) {
  const Mixed m(3);
  for (const Tangent tangent : {Tangent::kExact, Tangent::kProjected, Tangent::kWarped})
    for (const bool full : {false, true}) {
      const SoftBodyOptions options{.tangent = tangent, .full_damping_tangent = full};
      SoftBody whole("b", m.rest, m.materials, options, 0);
      std::vector<Figures> parts;
      for (int i = 0; i < 3; ++i) {
        SoftBody part("b", m.part(i), m.materials.list[static_cast<std::size_t>(i)], options, 0);
        parts.push_back(evaluate(part, whole, m));
      }
      expect_sum(evaluate(whole, whole, m), parts, full ? "full" : "symmetric");
    }
}

TEST(Materials, AveragesOfDilatationStayWithinEach) {
  const Mixed m(3);
  SoftBodyOptions options{.full_damping_tangent = true};
  for (const Material& material : m.materials.list)
    options.volumetric_shares.push_back(kept_volumetric_share(material));
  EXPECT_EQ(options.share_of(1), 1.0);  // nu = 0.2: no share is averaged
  EXPECT_LT(options.share_of(2), 0.1);
  NodalDilatation whole("b", m.rest, m.materials, options, 0);
  std::vector<Figures> parts;
  for (const int i : {0, 2}) {
    NodalDilatation part(
        "b", m.part(i), m.materials.list[static_cast<std::size_t>(i)],
        {.full_damping_tangent = true, .volumetric_share = options.share_of(static_cast<std::size_t>(i))}, 0);
    parts.push_back(evaluate(part, whole, m));
  }
  expect_sum(evaluate(whole, whole, m), parts, "dilatation");
  // Under uniform compression theta is uniform, whatever the materials are.
  OneBody pressed(flat(0.9 * m.rest.nodes), m.v);
  EXPECT_LT((whole.dilatations(pressed.state.view()) + VecX::Constant(m.rest.nodes.cols(), 0.3))
                .cwiseAbs()
                .maxCoeff(),
            1e-13);
}

TEST(Materials, DerivativesAreThoseOfTheForceAndTheEnergy) {
  const Mixed m(2);
  SoftBodyOptions options{.full_damping_tangent = true};
  for (const Material& material : m.materials.list)
    options.volumetric_shares.push_back(kept_volumetric_share(material));
  SoftBody body("b", m.rest, m.materials, options, 0);
  NodalDilatation dilatation("b", m.rest, m.materials, options, 0);
  const VecX still = VecX::Zero(m.x.size());
  for (dynamics::ForceTerm* term : std::initializer_list<dynamics::ForceTerm*>{&body, &dilatation}) {
    const std::string name(term->name());
    expect_slope_two(
        [&](double h) {
          const OneBody at(m.x + h * m.w, still);
          return VecX::Constant(1, term->energy(at.state.view()));
        },
        VecX::Constant(1, -force(*term, m.x, still).dot(m.w)), 4e-4, name);
    OneBody at(m.x, m.v);
    VecX product = still;
    term->apply_tangent(at.state.view(), 1.0, 0.0, m.w, product);
    expect_slope_two([&](double h) { return force(*term, m.x + h * m.w, m.v); }, -product, 4e-4, name);
    product.setZero();
    term->apply_tangent(at.state.view(), 0.0, 1.0, m.w, product);
    const VecX change = force(*term, m.x, m.v + m.w) - force(*term, m.x, m.v);
    EXPECT_LT((change + product).norm(), 1e-11 * change.norm()) << name;
  }
}

TEST(Materials, OneStepIsForceProductAndTangentInOne) {
  const Mixed m(10);  // several chunks
  for (const Tangent tangent : {Tangent::kExact, Tangent::kProjected, Tangent::kWarped}) {
    OneBody at(m.x, m.v);
    SoftBody body("b", m.rest, m.materials, {.tangent = tangent}, at.id);
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
      A.slot_map[static_cast<std::size_t>(s)] = A.slot_map[static_cast<std::size_t>(whole.body.slot(j, i))] =
          pairs++;
    });
    A.values.assign(9 * static_cast<std::size_t>(pairs), 0.0f);
    A.diagonal = VecX::Zero(m.x.size());
    A.slot_map_key = 1;
    VecX f = VecX::Zero(m.x.size()), want = f, product = f;
    body.add_step(at.state.view(), m.w, 0.7, 1.3, f, A);
    body.add_force(at.state.view(), want);
    body.apply_tangent(at.state.view(), 1.0, 0.0, m.w, product);
    EXPECT_LT((f - (want - product)).norm(), 1e-12 * f.norm());
    body.add_tangent(at.state.view(), 0.7, 1.3, whole);
    double largest = 0.0;
    for (const double value : whole.body.values()) largest = std::max(largest, std::abs(value));
    each_pair([&](int, int, int s) {
      const Mat3 stored = Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(
                              A.values.data() + 9 * A.slot_map[static_cast<std::size_t>(s)])
                              .cast<double>();
      const Mat3 exact = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(whole.body.block(s));
      EXPECT_LT((stored - exact).norm(), 1e-7 * exact.norm() + 1e-12 * largest) << "block " << s;
    });
    EXPECT_GT(pairs, 5000);
  }
}

TEST(Materials, TheSameMaterialInTwoRegionsIsThatOfOne) {
  const Mixed m(10);
  Materials twice({rubber(), rubber()}, m.materials.of_element);
  for (int& number : twice.of_element) number = number > 0;
  SoftBody one("b", m.rest, rubber(), {}, 0), two("b", m.rest, twice, {}, 0);
  const Figures a = evaluate(one, one, m, false), b = evaluate(two, two, m, false);
  EXPECT_LT((a.force - b.force).norm(), 1e-13 * a.force.norm());
  EXPECT_LT((a.product - b.product).norm(), 1e-13 * a.product.norm());
  EXPECT_NEAR(a.energy, b.energy, 1e-13 * a.energy);
  EXPECT_NEAR(a.power, b.power, 1e-13 * a.power);
  // A list of which only one material is used is bitwise equal to that material.
  SoftBody first(
      "b", m.rest,
      Materials({rubber(), stiff()}, std::vector<int>(static_cast<std::size_t>(m.rest.tets.cols()), 0)), {},
      0);
  EXPECT_EQ(evaluate(first, first, m, false).force, a.force);
  EXPECT_EQ(first.memory().elements, one.memory().elements);
}

TEST(Materials, ThreadsDoNotChangeABit) {
  const Mixed m(10);
  std::vector<Figures> found;
  for (const int threads : {1, 3}) {
    workers::set_count(threads);
    SoftBody body("b", m.rest, m.materials, {}, 0);
    found.push_back(evaluate(body, body, m, false));
  }
  workers::set_count(1);
  EXPECT_EQ(found[0].force, found[1].force);
  EXPECT_EQ(found[0].product, found[1].product);
  EXPECT_EQ(found[0].energy, found[1].energy);
}

// Unused vector lanes: at most seven per material and chunk.
TEST(Materials, CostAFewEmptyLanesAndNothingElse) {
  const Mixed m(10);
  Materials halves({soft(), stiff()}, {});
  for (const auto& tet : m.rest.tets.colwise())
    halves.of_element.push_back(m.rest.nodes(0, tet).mean() > 0.5);
  const std::size_t one = SoftBody("b", m.rest, soft(), {}, 0).memory().elements,
                    two = SoftBody("b", m.rest, halves, {}, 0).memory().elements;
  // 8 lanes of ten doubles, ten half-words and a word
  constexpr std::size_t kGroupBytes = 832, kRunBytes = 12, kChunks = 8;
  EXPECT_LE(two - one, kChunks * (kGroupBytes + kRunBytes));
}

TEST(Materials, MassesGoByElement) {
  const Mixed m(3);
  const VecX mixed = lumped_masses(m.rest, m.materials);
  VecX sum = VecX::Zero(m.rest.nodes.cols());
  OneBody at(m.x, m.v);
  VecX product = VecX::Zero(m.x.size()), parts = product,
       unit = flat(Vec3::UnitY().replicate(1, m.rest.nodes.cols()));
  make_consistent_mass(m.rest, m.materials, at.id)->apply(at.state.view(), m.v, product);
  for (int i = 0; i < 3; ++i) {
    const double density = m.materials.list[static_cast<std::size_t>(i)].density;
    sum += lumped_masses(m.part(i), density);
    make_consistent_mass(m.part(i), density, at.id)->apply(at.state.view(), m.v, parts);
  }
  EXPECT_LT((mixed - sum).cwiseAbs().maxCoeff(), 1e-15 * sum.sum());
  EXPECT_LT((product - parts).norm(), 1e-14 * parts.norm());
  product.setZero();
  make_consistent_mass(m.rest, m.materials, at.id)->apply(at.state.view(), unit, product);
  EXPECT_LT((unflat(product).row(1).transpose() - mixed).cwiseAbs().maxCoeff(), 1e-15 * sum.sum());
}

TEST(Materials, OthersInTheirPlacesActAtOnce) {
  const Mixed m(3);
  SoftBodyOptions options{.volumetric_shares = {0.5, 0.5, 0.5}};
  SoftBody body("b", m.rest, m.materials, options, 0);
  NodalDilatation dilatation("b", m.rest, m.materials, options, 0);
  Materials others = m.materials;
  others.list[1].youngs_modulus *= 3.0;
  others.list[0].mass_damping = 2.0;
  body.set_materials(others.list);
  dilatation.set_materials(others.list);
  SoftBody fresh("b", m.rest, others, options, 0);
  NodalDilatation fresh_dilatation("b", m.rest, others, options, 0);
  EXPECT_EQ(force(body, m.x, m.v), force(fresh, m.x, m.v));
  EXPECT_EQ(force(dilatation, m.x, m.v), force(fresh_dilatation, m.x, m.v));
}

TEST(Materials, WhatDoesNotFitIsRefused) {
  const Mixed m(1);
  Materials short_of_one = m.materials, beyond = m.materials, bad = m.materials;
  short_of_one.of_element.pop_back();
  beyond.of_element[2] = 3;
  bad.list[2].poissons_ratio = 0.5;
  expect_contains(message_of([&] { SoftBody("b", m.rest, short_of_one, {}, 0); }),
                  "5 material indices for 6 elements");
  expect_contains(message_of([&] { SoftBody("b", m.rest, beyond, {}, 0); }),
                  "material index 3 is not below 3");
  expect_contains(message_of([&] { SoftBody("b", m.rest, bad, {}, 0); }), "poissons_ratio = 0.5");
  expect_contains(message_of([&] { lumped_masses(m.rest, beyond); }), "material index 3 is not below 3");
  SoftBody body("b", m.rest, m.materials, {}, 0);
  expect_contains(message_of([&] { body.set_materials({soft()}); }), "1 materials given, expected 3");
}
