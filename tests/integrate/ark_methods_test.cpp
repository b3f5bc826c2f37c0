#include <cstdio>  // missing include of SUNDIALS 6.4

#include <arkode/arkode_butcher_dirk.h>
#include <arkode/arkode_butcher_erk.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <map>
#include <set>
#include <string>

#include "integrate/dense_ode.h"
#include "integrate/fakes.h"
#include "integrate/sundials/ark_methods.h"
#include "palpate/core/error.h"

/// Properties that ark_methods.cpp states for each table, computed from the tables of the installed version.
namespace palpate {
namespace {

using Complex = std::complex<double>;

struct Table {
  MatX A;
  VecX b, c;
  int order = 0, embedded = 0;
  explicit Table(ARKodeButcherTable t) {
    const int s = t->stages;
    A.resize(s, s);
    b = Eigen::Map<const VecX>(t->b, s);
    c = Eigen::Map<const VecX>(t->c, s);
    for (int i = 0; i < s; ++i)
      for (int j = 0; j < s; ++j) A(i, j) = t->A[i][j];
    order = t->q;
    embedded = t->p;
    ARKodeButcherTable_Free(t);
  }
  /// R(z) = 1 + z b^T (I - z A)^-1 1
  double amplification(Complex z) const {
    const auto s = A.rows();
    const Eigen::MatrixXcd M = Eigen::MatrixXcd::Identity(s, s) - z * A.cast<Complex>();
    const Eigen::VectorXcd stages = M.partialPivLu().solve(Eigen::VectorXcd::Ones(s));
    return std::abs(1.0 + z * (b.cast<Complex>().transpose() * stages)(0));
  }
  /// Returns whether the method is A-stable. Without a pole in the left half plane the maximum principle
  /// reduces the check to the imaginary axis; poles are at 1 / a_ii > 0.
  bool a_stable() const {
    if (A.diagonal().minCoeff() < 0.0) return false;
    for (double e = -4.0; e < 8.0; e += 0.01)
      if (amplification({0.0, std::pow(10.0, e)}) > 1.0 + 1e-9) return false;
    return true;
  }
  double at_infinity() const { return amplification({-1e8, 0.0}); }
  /// Returns whether a stiff mode leaves no error: b A^-1 c^j = 1 for all j > 0 (without a first explicit
  /// stage, where c = 0). This holds where b is the last row of A with c = 1; and in SDIRK-2-1, with c = (1,
  /// 0), b A^-1 = (1, 1/2).
  bool stiffly_accurate() const {
    const Eigen::Index e = A(0, 0) == 0.0 ? 1 : 0, n = A.rows() - e;
    const VecX row = MatX(A.bottomRightCorner(n, n)).transpose().partialPivLu().solve(b.tail(n));
    for (int j = 1; j <= 6; ++j)
      if (std::abs(row.dot(VecX(c.tail(n).array().pow(j))) - 1.0) > 1e-10) return false;
    return true;
  }
  int stage_order() const {
    int q = 0;
    while (q < 5 && (A * VecX(c.array().pow(q)) - VecX(c.array().pow(q + 1) / (q + 1))).norm() < 1e-10) ++q;
    return q;
  }
};

const std::vector<integrate::ArkMethod>& methods() { return integrate::ark_methods(); }

/// Defect of d^T A^(p-1) 1 = 1/p! for the embedded weights d of a pair p (p - 1): among the conditions of
/// order p, the one of the tall tree, which is the only one that matters for linear motion.
double tall_tree_defect(ARKodeButcherTable t) {
  const Table table(ARKodeButcherTable_Copy(t));
  VecX stages = VecX::Ones(t->stages);
  double factorial = 1.0;
  for (int k = 1; k < t->q; ++k) {
    stages = table.A * stages;
    factorial *= k;
  }
  const double defect =
      std::abs(Eigen::Map<const VecX>(t->d, t->stages).dot(stages) * factorial * t->q - 1.0);
  ARKodeButcherTable_Free(t);
  return defect;
}

TEST(ArkMethods, ThreePairsAreSharperOnLinearMotion) {
  int sharper = 0;
  for (const auto& m : methods()) {
    if (m.implicit_table < 0 || m.embedded_order >= m.traits.order) continue;
    const double defect =
        tall_tree_defect(ARKodeButcherTable_LoadDIRK(static_cast<ARKODE_DIRKTableID>(m.implicit_table)));
    EXPECT_EQ(m.sharper_on_linear_motion, defect < 1e-3) << m.name << ": " << defect;
    sharper += defect < 1e-3;
  }
  EXPECT_EQ(sharper, 3);
}

TEST(ArkMethods, ImplicitTablesAreAsStableAsTheySay) {
  int checked = 0;
  for (const auto& m : methods()) {
    if (m.implicit_table < 0) continue;
    const Table t(ARKodeButcherTable_LoadDIRK(static_cast<ARKODE_DIRKTableID>(m.implicit_table)));
    EXPECT_TRUE(t.a_stable()) << m.name;
    EXPECT_EQ(t.at_infinity() < 1e-5, m.traits.stability == dynamics::Stability::kL)
        << m.name << ": R(-inf) = " << t.at_infinity();
    EXPECT_EQ(t.order, m.traits.order) << m.name;
    EXPECT_EQ(t.embedded, m.embedded_order) << m.name;
    EXPECT_EQ(m.traits.stiff_order, t.stiffly_accurate() ? t.stage_order() : t.stage_order() + 1) << m.name;
    ++checked;
  }
  EXPECT_EQ(checked, 28);
}

TEST(ArkMethods, ExplicitTablesHaveTheirOrder) {
  int checked = 0;
  for (const auto& m : methods()) {
    if (m.explicit_table < 0 || m.implicit_table >= 0) continue;
    const Table t(ARKodeButcherTable_LoadERK(static_cast<ARKODE_ERKTableID>(m.explicit_table)));
    EXPECT_EQ(t.order, m.traits.order) << m.name;
    EXPECT_EQ(t.embedded, m.embedded_order) << m.name;
    ++checked;
  }
  EXPECT_EQ(checked, 4);
}

/// Largest y up to which |R(i y)| <= 1; zero if it exceeds 1 at once.
double imaginary_limit(const Table& t) {
  double y = 0.05;
  while (t.amplification({0.0, y}) <= 1.0) y += 1e-3;
  return y > 0.05 ? y : 0.0;
}

TEST(ArkMethods, ExplicitTablesSayWhatTheyDoToUndampedMotion) {
  const std::map<std::string, std::string> told = {{"ark-erk-2", "amplifies undamped motion at every step"},
                                                   {"ark-erk-3", "stable below 1.7/w_max"},
                                                   {"ark-erk-4", "stable below 2.8/w_max"},
                                                   {"ark-erk-5", "amplifies undamped motion at every step"}};
  const std::map<std::string, double> limit = {
      {"ark-erk-2", 0.0}, {"ark-erk-3", std::sqrt(3.0)}, {"ark-erk-4", std::sqrt(8.0)}, {"ark-erk-5", 0.0}};
  int checked = 0;
  for (const auto& m : methods()) {
    if (m.explicit_table < 0 || m.implicit_table >= 0) continue;
    const Table t(ARKodeButcherTable_LoadERK(static_cast<ARKODE_ERKTableID>(m.explicit_table)));
    EXPECT_NEAR(imaginary_limit(t), limit.at(m.name), 2e-3) << m.name;
    EXPECT_NE(m.summary.find(told.at(m.name)), std::string::npos) << m.name << ": " << m.summary;
    ++checked;
  }
  EXPECT_EQ(checked, 4);
}

TEST(ArkMethods, CashAndKarpAmplifyByTheSixthPower) {  // |R(iy)| = 1 + y^6/7200 + ...
  const Table t(ARKodeButcherTable_LoadERK(ARKODE_CASH_KARP_6_4_5));
  for (double y : {0.1, 0.2, 0.4})
    EXPECT_NEAR((t.amplification({0.0, y}) - 1.0) * 7200.0 / std::pow(y, 6), 1.0, 2.0 * y * y + 1e-3) << y;
}

// Covers the tables common to all tested releases; the tables that 7.1 added come after them.
TEST(ArkMethods, NoStableTableIsMissing) {
  std::set<int> listed;
  for (const auto& m : methods())
    if (m.implicit_table >= 0 && m.explicit_table < 0) listed.insert(m.implicit_table);
  int stable = 0;
  for (int id = ARKODE_MIN_DIRK_NUM; id <= ARKODE_ESDIRK547L2SA2_7_4_5; ++id) {
    const Table t(ARKodeButcherTable_LoadDIRK(static_cast<ARKODE_DIRKTableID>(id)));
    if (!t.a_stable()) continue;
    ++stable;
    EXPECT_EQ(listed.count(id), 1u) << "table " << id;
  }
  EXPECT_EQ(stable, 23);
}

// --- Order on a stiff mode
//
// Prothero and Robinson's problem in mechanical form: a stiff spring and damper that follow a smooth motion
// g(t),
//     q' = u,   u' = -w^2 (q - g) - 2 w (u - g') + g'',       y = (q, u),  y' = L (y - G) + G',
//     G = (g, g'),
// both eigenvalues of L are -w, and h w >> 1. From G(0) the exact solution is G. Substituting G into the
// stages (c^j by entries; A, b, c the table) gives the defects
//     D = sum_j h^(j+1) d_j G^(j+1) / j!,  d_j = c^(j+1) / (j+1) - A c^j  of the stages, and
//     e_j = 1 / (j+1) - b.c^j  of the step.
// d_j = 0 below the stage order. The errors E of the stages and e of the step then satisfy
//     E = e_n + h A L E - D,  e_(n+1) = e_n + h b L E - (e_j terms), so that
//     e_(n+1) = R(h L) e_n + sum_j h^(j+1) / j! [ (b A^-1 d_j - e_j) + (h L)^-1 b A^-2 d_j
//               + O((h w)^-2) ] G^(j+1),     L^-1 = [-2/w, -1/w^2; 1, 0].
// (A first explicit stage has d = 0 and is left out of A, b and d.) R(h L) = R(-inf) + O((h L)^-1) with
// |R(-inf)| < 1: errors decay rather than accumulate.
//   stiffly accurate  b A^-1 d_j = e_j for all j. The remainder is (h L)^-1: position 2/w h^j, velocity h^j,
//                     j the first with b A^-2 d_j != 0, in general the stage order, in both. The velocity
//                     error has no factor 1/w: a stiff spring's velocity is the derivative of a constraint.
//   else              position h^(j+1), j the first with b A^-1 d_j != e_j; the velocity loses one order to
//                     (h L)^-1 times that, or to b A^-2 d_j != 0.
// With all stiffness in the damper, q would be slow, and terms of order h^j here would be masked by the
// classical error of q: hence the coefficients w^2 and 2 w.

struct StiffOrders {
  int position = 0, velocity = 0;
};

StiffOrders stiff_orders(const Table& t) {
  const Eigen::Index s = t.A.rows(), explicit_first = t.A(0, 0) == 0.0 ? 1 : 0, n = s - explicit_first;
  const MatX inverse = MatX(t.A.bottomRightCorner(n, n)).inverse();
  const VecX b = t.b.tail(n);
  StiffOrders out;
  for (int j = 1; j <= 5 && out.position * out.velocity == 0; ++j) {
    const VecX d = (VecX(t.c.array().pow(j + 1) / (j + 1)) - t.A * VecX(t.c.array().pow(j))).tail(n);
    const double e = 1.0 / (j + 1) - t.b.dot(VecX(t.c.array().pow(j)));
    const bool direct = std::abs(b.dot(inverse * d) - e) > 1e-8,
               next = std::abs(b.dot(inverse * (inverse * d))) > 1e-8;
    if (out.velocity == 0 && (direct || next)) out.velocity = j;
    if (out.position == 0 && t.stiffly_accurate() && next) out.position = j;
    if (out.position == 0 && !t.stiffly_accurate() && direct) out.position = j + 1;
  }
  return out;
}

constexpr double kStiff = 1e5;  // w [1/s]: h w from 1000 to 8000

/// The stiff part: implicit wherever a method has an implicit side.
struct Follow final : dynamics::ForceTerm {
  std::string_view name() const override { return "follow"; }
  dynamics::TermTraits traits() const override { return {}; }
  void add_force(const dynamics::StateView& s, VecX& f) override {
    f.array() +=
        -kStiff * kStiff * (s.q.array() - std::sin(s.time)) - 2.0 * kStiff * (s.u.array() - std::cos(s.time));
  }
  void add_tangent(const dynamics::StateView&, double k, double d, dynamics::BorderedMatrix& A) override {
    A.body.add(0, (k * kStiff * kStiff + d * 2.0 * kStiff) * Mat3::Identity());
  }
  void apply_tangent(const dynamics::StateView&, double k, double d, const VecX& x, VecX& y) override {
    y += (k * kStiff * kStiff + d * 2.0 * kStiff) * x;
  }
};

/// g'': on the explicit side of an additive pair, whose defects have an additional factor (h w)^-1 there and
/// change no order.
struct Push final : dynamics::ForceTerm {
  std::string_view name() const override { return "push"; }
  dynamics::TermTraits traits() const override { return {.stiff = false}; }
  void add_force(const dynamics::StateView& s, VecX& f) override { f.array() -= std::sin(s.time); }
  void add_tangent(const dynamics::StateView&, double, double, dynamics::BorderedMatrix&) override {}
  void apply_tangent(const dynamics::StateView&, double, double, const VecX&, VecX&) override {}
};

struct StiffErrors {
  double position = 0.0, velocity = 0.0;
};

/// Largest errors from 0.8 to 1.6 s, after the errors of the first steps have decayed.
StiffErrors stiff_errors(const std::string& name, double h) {
  dynamics::State state;
  dynamics::System system;
  const int id = state.insert(dynamics::BlockSpec{.name = "one", .q_size = 3, .u_size = 3}, VecX::Zero(3),
                              VecX::Ones(3));
  system.add(std::make_shared<Follow>());
  system.add(std::make_shared<Push>());
  system.add(std::make_shared<fakes::NodalMass>(id, MatX::Identity(3, 3)));
  system.prepare(state.view());
  IntegratorSpec spec;
  spec.name = name;
  spec.fixed_step = true;
  spec.step_s = h;
  spec.newton_rtol = 1e-10;  // the problem is linear: the second correction is at rounding level
  const auto stepper = integrate::make_stepper(system, state, spec);
  StiffErrors worst;
  for (int n = 1; n <= 10; ++n) {
    const auto result = stepper->advance_to(0.16 * n);
    if (!result.ok()) fail("{}", result.message);
    if (n < 5) continue;
    worst.position = std::max(worst.position, std::abs(state.q()[0] - std::sin(0.16 * n)));
    worst.velocity = std::max(worst.velocity, std::abs(state.u()[0] - std::cos(0.16 * n)));
  }
  return worst;
}

TEST(ArkMethods, HaveTheirStiffOrder) {
  int checked = 0;
  for (const auto& m : methods()) {
    if (m.implicit_table < 0) continue;
    const StiffOrders expected =
        stiff_orders(Table(ARKodeButcherTable_LoadDIRK(static_cast<ARKODE_DIRKTableID>(m.implicit_table))));
    EXPECT_GE(expected.position, m.traits.stiff_order) << m.name;
    std::vector<double> steps = {0.08, 0.04, 0.02, 0.01}, position, velocity;
    for (const double h : steps) {
      const StiffErrors e = stiff_errors(m.name, h);
      position.push_back(e.position);
      velocity.push_back(e.velocity);
    }
    const double p = fakes::slope(steps, position), v = fakes::slope(steps, velocity);
    RecordProperty(m.name, fmt::format("position {:.2f} of {}, velocity {:.2f} of {}", p, expected.position,
                                       v, expected.velocity));
    EXPECT_NEAR(p, expected.position, 0.15) << m.name << ", finest " << position.back();
    EXPECT_NEAR(v, expected.velocity, 0.15) << m.name << ", finest " << velocity.back();
    ++checked;
  }
  EXPECT_EQ(checked, 28);
}

/// Amplification of one step of y' = l_I y + l_E y, h = 1: R = 1 + (l_I b_I + l_E b_E)^T Z with the stages Z
/// = (I - l_I A_I - l_E A_E)^-1 1.
double one_step(const integrate::ArkMethod& m, double l_implicit, double l_explicit) {
  MatX A;
  VecX b;
  const auto add = [&](const Table& t, double l) {
    if (A.size() == 0) A = MatX::Zero(t.A.rows(), t.A.rows()), b = VecX::Zero(t.A.rows());
    A += l * t.A;
    b += l * t.b;
  };
  if (m.implicit_table >= 0)
    add(Table(ARKodeButcherTable_LoadDIRK(static_cast<ARKODE_DIRKTableID>(m.implicit_table))), l_implicit);
  if (m.explicit_table >= 0)
    add(Table(ARKodeButcherTable_LoadERK(static_cast<ARKODE_ERKTableID>(m.explicit_table))), l_explicit);
  const auto s = A.rows();
  return 1.0 + b.dot(VecX((MatX::Identity(s, s) - A).partialPivLu().solve(VecX::Ones(s))));
}

/// n equal steps of a linear equation equal the n-th power of one step, unless a step starts with an f other
/// than that of its initial state. Both sides of the method act.
TEST(ArkMethods, EachStepBeginsWhereTheLastOneEnded) {
  constexpr double kImplicit = -0.9, kExplicit = 0.4, kStep = 0.5;
  constexpr int kSteps = 4;
  int checked = 0;
  for (const auto& m : methods()) {
    const bool one_side = m.implicit_table < 0 || m.explicit_table < 0;
    const fakes::Equation e{
        [&](const VecX& y, VecX& f) { f = (one_side ? kImplicit + kExplicit : kImplicit) * y; },
        [&](const VecX&, MatX& J) { J(0, 0) = one_side ? kImplicit + kExplicit : kImplicit; }, VecX::Ones(1),
        VecX::Ones(1), [&](const VecX& y, VecX& g) { g = (one_side ? 0.0 : kExplicit) * y; }};
    const double l_implicit = kStep * (one_side ? kImplicit + kExplicit : kImplicit),
                 l_explicit = kStep * (one_side ? kImplicit + kExplicit : kExplicit);
    IntegratorSpec spec;
    spec.name = m.name;
    spec.fixed_step = true;
    spec.step_s = kStep;
    spec.newton_rtol = 1e-12;
    VecX y;
    double t = 0.0;
    const auto stepper =
        integrate::make_ode_stepper(std::make_unique<fakes::DenseOde>(e, spec.rtol, y, t), spec);
    const auto result = stepper->advance_to(kSteps * kStep);
    ASSERT_TRUE(result.ok()) << m.name << ": " << result.message;
    EXPECT_NEAR(y[0] / std::pow(one_step(m, l_implicit, l_explicit), kSteps), 1.0, 1e-11) << m.name;
    ++checked;
  }
  EXPECT_EQ(checked, static_cast<int>(methods().size()));
}

}  // namespace
}  // namespace palpate
