#include <cstdlib>

#include "law_reference.h"
#include "palpate/core/workers.h"

using namespace palpate;
using namespace palpate::fem;
using namespace palpate::fem::testing;

namespace {

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

}  // namespace

TEST(Lanes, EveryShapeGetsWhatTheScalarFormulasGive) {
  // Tolerance relative to each element's norm. Where two signed singular values nearly cancel, R changes by a
  // rounding of F divided by their sum, and C by that divided by the sum again.
  Random random(81);
  std::vector<Mat3> deformations;
  std::vector<double> sums;
  const auto add = [&](const Vec3& s) {
    deformations.push_back(deformation(random, s));
    sums.push_back(s[1] + s[2]);
  };
  for (int i = 0; i < 40; ++i) {
    add(Vec3(1.3, 1.0, 0.8) + 0.25 * Vec3(random.vector(3)));
    add(Vec3(1.2 + 0.3 * random(), 0.8 + 0.2 * random(), 0.0));                     // flat
    add(Vec3(1.2 + 0.2 * random(), 0.8 + 0.1 * random(), -0.35 + 0.3 * random()));  // inverted
    add(Vec3(4.0 + random(), 2.0 + 0.9 * random(), 0.5 + 0.4 * random()));          // far from rest
    add(Vec3(0.05, 0.03, 0.01) * (1.0 + 0.1 * random()));                           // crushed
    add(Vec3(1.0, 0.4, -0.4 + 1e-3 * (1.5 + random())));                            // near the singular set
  }
  const Apart m(deformations, random);
  for (const std::string& instructions : instruction_sets())
    for (Tangent tangent : {Tangent::kExact, Tangent::kProjected, Tangent::kWarped})
      for (bool full : {false, true}) {
        const Evaluation found =
            evaluate(m.rest, damped_material(), options(tangent, full, instructions), m.x, m.v, m.w, false);
        const Reference expected =
            reference(law_called("corotational"), m.rest, damped_material(), tangent, full, m.x, m.v, m.w);
        for (std::size_t e = 0; e < sums.size(); ++e) {
          const auto at = static_cast<Eigen::Index>(12 * e);
          const double close = std::min(1.0, sums[e]);
          EXPECT_LT(apart(found.f.segment<12>(at), expected.f.segment<12>(at)), 1e-13 + 1e-14 / close)
              << instructions << ", element " << e;
          EXPECT_LT(apart(found.y.segment<12>(at), expected.y.segment<12>(at)),
                    1e-13 + 2e-15 / (close * close))
              << instructions << ", element " << e;
        }
        EXPECT_NEAR(found.energy, expected.energy, 1e-13 * expected.energy);
        EXPECT_NEAR(found.power, expected.power, 1e-13 * expected.power);
        EXPECT_GE(found.counts.inverted, 80);
        EXPECT_LE(found.counts.inverted, 120);  // flat elements: the sign is decided by rounding
        if (tangent == Tangent::kExact) {
          EXPECT_EQ(found.counts.by_scalar, 2 * 40);  // the last kind: R in the force and in the tangent
        }
      }
}

TEST(Lanes, ChunksAddUpToTheScalarSum) {
  const Shaken m(9, 0.02, 83);  // 4,374 elements in three chunks; the last group is not full
  for (const std::string& instructions : instruction_sets())
    for (bool full : {false, true}) {
      const Evaluation found = evaluate(m.rest, damped_material(),
                                        options(Tangent::kExact, full, instructions), m.x, m.v, m.w, false);
      const Reference expected = reference(law_called("corotational"), m.rest, damped_material(),
                                           Tangent::kExact, full, m.x, m.v, m.w);
      EXPECT_LT(apart(found.f, expected.f), 1e-13) << instructions;
      EXPECT_LT(apart(found.y, expected.y), 1e-12) << instructions;
      EXPECT_NEAR(found.energy, expected.energy, 1e-13 * expected.energy);
      EXPECT_NEAR(found.power, expected.power, 1e-13 * expected.power);
      OneBody at(m.x, m.v);
      SoftBody body("b", m.rest, damped_material(), options(Tangent::kExact, full, instructions), at.id);
      dynamics::PatternBuilder builder(at.state.layout());
      body.add_pattern(builder);
      dynamics::BorderedMatrix A;
      A.body = builder.build();
      body.add_tangent(at.state.view(), 0.7, 1.9, A);
      VecX product;
      A.multiply(m.w, product);
      EXPECT_LT(apart(product, expected.y), 1e-12) << instructions;
    }
}

TEST(Lanes, InstructionSetsAgree) {
  const Shaken m(5, 0.09, 85);
  const std::vector<std::string> sets = instruction_sets();
  EXPECT_EQ(sets.front(), "baseline");
  for (Tangent tangent : {Tangent::kExact, Tangent::kProjected, Tangent::kWarped}) {
    const Evaluation base =
        evaluate(m.rest, damped_material(), options(tangent, true, "baseline"), m.x, m.v, m.w, true);
    EXPECT_GT(base.counts.inverted, 3);
    for (const std::string& instructions : sets) {
      const Evaluation found =
          evaluate(m.rest, damped_material(), options(tangent, true, instructions), m.x, m.v, m.w, true);
      EXPECT_LT(apart(found.f, base.f), 1e-12) << instructions;
      EXPECT_LT(apart(found.y, base.y), 1e-12) << instructions;
      EXPECT_LT((found.A - base.A).norm(), 1e-12 * base.A.norm()) << instructions;
      EXPECT_NEAR(found.energy, base.energy, 1e-12 * base.energy);
      EXPECT_NEAR(found.power, base.power, 1e-12 * base.power);
      EXPECT_EQ(found.counts.inverted, base.counts.inverted);
    }
  }
}

TEST(Lanes, ThreadsChangeNoBit) {
  const Shaken m(10, 0.03, 87);  // 6,000 elements in three chunks
  for (Tangent tangent : {Tangent::kExact, Tangent::kProjected, Tangent::kWarped}) {
    workers::set_count(1);
    const Evaluation alone = evaluate(
        m.rest, damped_material(), {.tangent = tangent, .full_damping_tangent = true}, m.x, m.v, m.w, false);
    for (int threads : {2, 3, 5})
      for (int repeat = 0; repeat < 3; ++repeat) {
        workers::set_count(threads);
        const Evaluation found =
            evaluate(m.rest, damped_material(), {.tangent = tangent, .full_damping_tangent = true}, m.x, m.v,
                     m.w, false);
        EXPECT_EQ(found.f, alone.f);
        EXPECT_EQ(found.y, alone.y);
        EXPECT_EQ(found.values, alone.values);
        EXPECT_EQ(found.energy, alone.energy);
        EXPECT_EQ(found.power, alone.power);
        EXPECT_EQ(found.counts.inverted, alone.counts.inverted);
        EXPECT_EQ(found.counts.by_scalar, alone.counts.by_scalar);
      }
  }
  workers::set_count(1);
}

TEST(Lanes, ExactTangentIsTheDerivativeUpToTheSingularSetAndCountsItsClampThere) {
  const TetMesh rest = one_tet();
  Random random(89);
  for (const std::string& instructions : instruction_sets()) {
    SoftBody body("b", rest, soft_material(), {.instructions = instructions}, 0);
    const auto force_at = [&](const VecX& x) {
      OneBody at(x, VecX::Zero(12));
      VecX f = VecX::Zero(12);
      body.add_force(at.state.view(), f);
      return f;
    };
    const auto tangent_times = [&](const VecX& x, const VecX& w) {
      OneBody at(x, VecX::Zero(12));
      dynamics::PatternBuilder builder(at.state.layout());
      body.add_pattern(builder);
      dynamics::BorderedMatrix A;
      A.body = builder.build();
      body.add_tangent(at.state.view(), 1, 0, A);
      VecX y;
      A.multiply(w, y);
      return y;
    };
    int tested = 0;
    for (double sum : {0.5, 0.1, 0.02, 3e-3, 1e-3}) {
      const VecX x = flat(deformation(random, {1.2, 0.6, -0.6 + sum}) * rest.nodes), w = random.vector(12);
      expect_slope_two([&](double h) { return force_at(x + h * w); }, -tangent_times(x, w), 0.01 * sum,
                       fmt::format("{} from the singular set", sum), 5);
      ++tested;
    }
    EXPECT_EQ(tested, 5);
    EXPECT_EQ(body.counts().clamped, 0);
    EXPECT_GT(body.counts().inverted, 0);
    const VecX on = flat(Vec3(1.2, 0.5, -0.5).asDiagonal() * rest.nodes);
    EXPECT_TRUE(tangent_times(on, VecX::Ones(12)).allFinite());
    EXPECT_EQ(body.counts().clamped, 1);
  }
}

TEST(Lanes, InstructionsByNameAndByEnvironment) {
  SoftBody baseline("b", one_tet(), soft_material(), {.instructions = "baseline"}, 0);
  EXPECT_EQ(baseline.instructions(), "baseline");
  expect_contains(
      message_of([] { SoftBody("liver", one_tet(), soft_material(), {.instructions = "mmx"}, 0); }),
      "body \"liver\": instructions = \"mmx\" is not supported by this build or this processor; the choices "
      "are baseline, avx2 and avx512");
  setenv("PALPATE_INSTRUCTIONS", "baseline", 1);
  EXPECT_EQ(SoftBody("b", one_tet(), soft_material(), {}, 0).instructions(), "baseline");
  setenv("PALPATE_INSTRUCTIONS", "sse9", 1);
  expect_contains(message_of([] { SoftBody("b", one_tet(), soft_material(), {}, 0); }),
                  "PALPATE_INSTRUCTIONS = \"sse9\"");
  unsetenv("PALPATE_INSTRUCTIONS");
  EXPECT_EQ(SoftBody("b", one_tet(), soft_material(), {}, 0).instructions(), instruction_sets().back());
}

TEST(Lanes, NotANumberStaysWhereItIsAndIsNoCrash) {
  Shaken m(2, 0.02, 91);
  m.x[0] = std::nan("");
  const Evaluation found = evaluate(m.rest, damped_material(), {}, m.x, m.v, m.w, false);
  EXPECT_TRUE(std::isnan(found.f[0]));
  // the node at the opposite corner shares no element with it
  EXPECT_TRUE(found.f.tail<3>().allFinite());
}

TEST(Lanes, MemoryIsSaid) {
  const Shaken m(6, 0.02, 93);
  OneBody at(m.x, m.v);
  SoftBody body("b", m.rest, soft_material(), {}, at.id);
  const auto count = static_cast<std::size_t>(m.rest.tets.cols());
  // at least ten numbers of the rest shape and four nodes
  EXPECT_GE(body.memory().elements, 96 * count);
  EXPECT_LT(body.memory().elements, 400 * count);
  EXPECT_EQ(body.memory().maps, 0u);  // before the first matrix
}
