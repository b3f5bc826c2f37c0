#include "core/counters.h"
#include "fem_fixture.h"
#include "palpate/core/workers.h"
#include "palpate/dynamics/zero_row_sum_matrix.h"

using namespace palpate;
using namespace palpate::fem;
using namespace palpate::fem::testing;

namespace {

constexpr double kK = 0.37, kD = 0.6, kScale = 8.0;

/// Storage for a zero-row-sum matrix in another order: blocks backwards.
struct Room {
  dynamics::BlockSparse pattern;
  dynamics::ZeroRowSumMatrix A;
  explicit Room(const SoftBody& body, const dynamics::State& state) {
    dynamics::PatternBuilder builder(state.layout());
    body.add_pattern(builder);
    pattern = builder.build();
    A.pattern = &pattern;
    A.slot_map.assign(static_cast<std::size_t>(pattern.slot_count()), -1);
    int next = (pattern.slot_count() - pattern.block_rows()) / 2;
    A.values.assign(9 * static_cast<std::size_t>(next), 77.0f);
    each_pair([&](int i, int j, int slot) {
      if (i < j)
        A.slot_map[static_cast<std::size_t>(slot)] =
            A.slot_map[static_cast<std::size_t>(pattern.slot(j, i))] = --next;
    });
    A.scale = kScale;
    A.diagonal = VecX::Ones(state.layout().u_size);
    A.slot_map_key = 1;
  }
  template <class Work>
  void each_pair(Work&& work) const {
    for (int i = 0; i < pattern.block_rows(); ++i)
      for (int s = pattern.row_start()[static_cast<std::size_t>(i)];
           s < pattern.row_start()[static_cast<std::size_t>(i) + 1]; ++s)
        if (pattern.columns()[static_cast<std::size_t>(s)] != i)
          work(i, pattern.columns()[static_cast<std::size_t>(s)], s);
  }
  Mat3 block(int i, int j, int slot) const {
    const Mat3 above = Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(
                           A.values.data() + 9 * A.slot_map[static_cast<std::size_t>(slot)])
                           .cast<double>() /
                       kScale;
    return i < j ? above : above.transpose();
  }
};

struct Case {
  TetMesh rest;  // ten cells along an edge: three chunks
  VecX x, v, w, change;
  explicit Case(double shake, int cells = 10) : rest(jittered_cube(cells, 0.15, 31)) {
    Random random(32);
    x = flat(random.rotation() * rest.nodes) + shake * random.vector(3 * rest.nodes.cols());
    v = random.vector(x.size());
    w = random.vector(x.size());
    change = random.vector(x.size());
  }
};

Material material_with(double stiffness_damping, double mass_damping) {
  Material m = soft_material();
  m.stiffness_damping = stiffness_damping;
  m.mass_damping = mass_damping;
  return m;
}

std::vector<std::string> sets_here() {
  std::vector<std::string> out;
  for (const char* name : {"baseline", "avx2", "avx512"})
    if (message_of([&] { SoftBody("b", one_tet(), soft_material(), {.instructions = name}, 0); }).empty())
      out.emplace_back(name);
  return out;
}

}  // namespace

// Fused assembly equals three evaluations: force minus stiffness times the shift, and every off-diagonal
// block to single precision.
TEST(Step, IsForceProductAndTangentInOne) {
  int compared = 0;
  for (const std::string& set : sets_here())
    for (const Tangent tangent : {Tangent::kExact, Tangent::kProjected, Tangent::kWarped})
      for (const double shake : {0.01, 0.12})  // the second inverts elements
        for (const Material& material : {material_with(0.0, 0.0), material_with(0.4, 0.3)}) {
          const Case c(shake);
          OneBody at(c.x, c.v);
          SoftBody body("b", c.rest, material, {.tangent = tangent, .instructions = set}, at.id);
          ASSERT_TRUE(body.fuses_step());
          Room room(body, at.state);
          VecX f = VecX::Zero(c.x.size()), product = f, want = f;
          body.add_step(at.state.view(), c.w, kK, kD, f, room.A);
          const ElementCounts counts = body.counts();
          EXPECT_EQ(counts.inverted > 0, shake > 0.1);
          body.reset_counts();
          dynamics::BorderedMatrix whole;
          whole.body = room.pattern;
          body.add_tangent(at.state.view(), kK, kD, whole);
          EXPECT_EQ(body.counts().clamped, counts.clamped);
          body.add_force(at.state.view(), want);
          EXPECT_EQ(body.counts().inverted, counts.inverted);
          body.apply_tangent(at.state.view(), 1.0, 0.0, c.w, product);
          want -= product;
          EXPECT_LT((f - want).norm(), 1e-12 * want.norm()) << set;
          product.setZero();
          body.apply_tangent(at.state.view(), 0.0, 1.0, c.change, product);
          VecX left = VecX::Zero(c.x.size());
          body.add_step_force(at.state.view(), c.w, c.change, left);
          EXPECT_LT((left - (want - product)).norm(), 1e-12 * want.norm()) << set << ", without the matrix";
          constexpr double kRate = 30.0;
          const VecX to_rate = kRate * c.w - c.v;
          VecX by_velocity = VecX::Zero(c.x.size()), by_shift = by_velocity;
          body.add_step_force(at.state.view(), c.w, to_rate, by_velocity);
          body.add_step_force_at_rate(at.state.view(), c.w, to_rate, kRate, by_shift);
          EXPECT_LT((by_shift - by_velocity).norm(), 1e-12 * by_velocity.norm()) << set;
          EXPECT_EQ(product.norm() > 0.0, material.stiffness_damping > 0.0);

          double largest = 0.0;
          for (const double value : whole.body.values()) largest = std::max(largest, std::abs(value));
          const VecX masses = lumped_masses(c.rest, material.density);
          room.each_pair([&](int i, int j, int s) {
            const Mat3 exact =
                Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(whole.body.block(s));
            EXPECT_LT((room.block(i, j, s) - exact).norm(), 1e-7 * exact.norm() + 1e-12 * largest)
                << set << ", block " << s;
            ++compared;
          });
          for (int i = 0; i < room.pattern.block_rows(); ++i) {
            for (int axis = 0; axis < 3; ++axis)
              EXPECT_NEAR(room.A.diagonal[3 * i + axis], 1.0 + kD * material.mass_damping * masses[i], 1e-14);
          }
        }
  EXPECT_GT(compared, 100000);
}

// In a large body, blocks of one chunk are written while the next one is computed. Evaluated twice: the
// buffers must be zero again.
TEST(Step, OfALargeBodyIsTheSame) {
  const Case c(0.01, 24);
  ASSERT_GT(c.rest.tets.cols(), 16 * 4096) << "more than sixteen chunks";
  for (const std::string& set : sets_here())
    for (const int threads : {1, 3}) {
      workers::set_count(threads);
      OneBody at(c.x, c.v);
      SoftBody body("b", c.rest, material_with(0.0, 0.0), {.tangent = Tangent::kWarped, .instructions = set},
                    at.id);
      Room room(body, at.state);
      VecX f = VecX::Zero(c.x.size());
      dynamics::BorderedMatrix whole;
      whole.body = room.pattern;
      body.add_tangent(at.state.view(), kK, kD, whole);
      for (int run = 0; run < 2; ++run) {
        std::fill(room.A.values.begin(), room.A.values.end(), 77.0f);
        body.add_step(at.state.view(), c.w, kK, kD, f, room.A);
        double worst = 0.0;
        room.each_pair([&](int i, int j, int s) {
          const Mat3 exact =
              Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(whole.body.block(s));
          worst = std::max(worst, (room.block(i, j, s) - exact).norm() / exact.norm());
        });
        EXPECT_LT(worst, 1e-6) << set << ", " << threads << " threads, run " << run;
      }
    }
  workers::set_count(1);
}

TEST(Step, ThreadsDoNotChangeABit) {
  const Case c(0.08);
  std::vector<VecX> forces;
  std::vector<std::vector<float>> values;
  for (const int threads : {1, 2, 3}) {
    workers::set_count(threads);
    OneBody at(c.x, c.v);
    SoftBody body("b", c.rest, material_with(0.4, 0.3), {}, at.id);
    Room room(body, at.state);
    VecX f = VecX::Zero(c.x.size());
    body.add_step(at.state.view(), c.w, kK, kD, f, room.A);
    body.add_step_force(at.state.view(), c.w, c.change, f);
    forces.push_back(f);
    values.push_back(room.A.values);
  }
  workers::set_count(1);
  EXPECT_EQ(forces[0], forces[1]);
  EXPECT_EQ(forces[0], forces[2]);
  EXPECT_EQ(values[0], values[1]);
  EXPECT_EQ(values[0], values[2]);
}

TEST(Step, AnUnsymmetricTangentIsNotBalanced) {
  const Case c(0.01);
  OneBody at(c.x, c.v);
  const SoftBody body("b", c.rest, material_with(0.4, 0.0), {.full_damping_tangent = true}, at.id);
  EXPECT_FALSE(body.fuses_step());
}

// Two matrices of different orders alternate (a step's matrix, and one for model reduction): each equals its
// separate assembly, and the map into each is built once.
TEST(Step, MatricesOfTwoOrdersTakeTurns) {
  const Case c(0.01);
  OneBody at(c.x, c.v);
  SoftBody body("b", c.rest, material_with(0.4, 0.3), {.tangent = Tangent::kWarped}, at.id);
  Room forth(body, at.state), back(body, at.state);
  const int pairs = (back.pattern.slot_count() - back.pattern.block_rows()) / 2;
  for (int& slot : back.A.slot_map) slot = slot < 0 ? slot : pairs - 1 - slot;
  back.A.slot_map_key = 2;
  VecX f = VecX::Zero(c.x.size());
  const long before = counters::counter("fem.scatter_map");
  for (int turn = 0; turn < 3; ++turn) {
    for (Room* room : {&forth, &back}) {
      std::fill(room->A.values.begin(), room->A.values.end(), 77.0f);
      body.add_step(at.state.view(), c.w, kK, kD, f, room->A);
    }
    int compared = 0;
    forth.each_pair([&](int i, int j, int s) {
      EXPECT_EQ(forth.block(i, j, s), back.block(i, j, s)) << "turn " << turn << ", block " << s;
      ++compared;
    });
    EXPECT_GT(compared, 10000);
  }
  EXPECT_EQ(counters::counter("fem.scatter_map") - before, 2);
}

// The key of a kept step (dynamics::CachedStep) changes with materials and tangents, and is restored with
// them.
TEST(Step, VersionsTellWhenItWouldBeAnother) {
  const Case c(0.01);
  OneBody at(c.x, c.v);
  SoftBody body("b", c.rest, soft_material(), {}, at.id), other("c", c.rest, soft_material(), {}, at.id);
  const std::uint64_t first = body.step_version();
  EXPECT_NE(first, 0u);
  EXPECT_NE(first, other.step_version());
  body.project_to_psd(true);
  EXPECT_NE(body.step_version(), first);
  body.project_to_psd(false);
  EXPECT_EQ(body.step_version(), first);
  body.set_materials({soft_material()});
  EXPECT_NE(body.step_version(), first);
}
