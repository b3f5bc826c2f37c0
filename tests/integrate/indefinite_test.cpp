#include <gtest/gtest.h>

#include "integrate/fakes.h"
#include "integrate/registry_test_name.h"

namespace palpate {
namespace {

using namespace fakes;

/// f = -K (q - q0), optionally with a definite matrix in the place of K.
struct Buckling final : ForceTerm, public PsdProjectedTerm {
  MatX K, definite_K;
  bool definite = false;
  long definite_tangents = 0;
  Buckling(MatX k, MatX stand_in) : K(std::move(k)), definite_K(std::move(stand_in)) {}
  std::string_view name() const override { return "buckling"; }
  TermTraits traits() const override { return {}; }
  void project_to_psd(bool on) override { definite = on; }
  void add_force(const StateView& s, VecX& f) override { f -= K * s.q; }
  void add_tangent(const StateView&, double k, double, BorderedMatrix& A) override {
    if (definite && k != 0.0) ++definite_tangents;
    for (int i = 0; i < K.rows() / 3; ++i)
      A.body.add(A.body.slot(i, i), k * (definite ? definite_K : K).block<3, 3>(3 * i, 3 * i));
  }
  void apply_tangent(const StateView&, double k, double, const VecX& x, VecX& y) override {
    y += k * ((definite ? definite_K : K) * x);
  }
};

/// Two uncoupled unit masses at an unstable equilibrium: q'' = 100 q along x of the first, stable in all
/// other directions. M + gamma^2 K is indefinite exactly for gamma > 0.1.
struct Unstable {
  State state;
  System system;
  std::shared_ptr<Buckling> term;
  explicit Unstable(bool has_definite_tangent) {
    const int id =
        state.insert(BlockSpec{.name = "masses", .q_size = 6, .u_size = 6}, VecX::Zero(6), VecX::Zero(6));
    MatX K = 100.0 * MatX::Identity(6, 6);
    K(0, 0) = -100.0;
    MatX stand_in = K;
    if (has_definite_tangent) stand_in(0, 0) = 0.0;  // the nearest positive semi-definite matrix
    term = std::make_shared<Buckling>(K, stand_in);
    system.add(std::static_pointer_cast<ForceTerm>(term));
    system.add(std::make_shared<NodalMass>(id, MatX::Identity(6, 6)));
    system.prepare(state.view());
  }
};

std::vector<std::string> implicit_methods() {
  std::vector<std::string> out;
  for (const auto& entry : integrate::stepper_registry())
    if (entry.traits.implicit && entry.traits.stability != Stability::kStatic) out.push_back(entry.name);
  return out;
}

class Indefinite : public testing::TestWithParam<std::string> {
 protected:
  /// From rest at the equilibrium there is no error and no force: adaptive steps grow past gamma = 0.1, and
  /// fixed steps are set beyond it.
  StepperCounters counts(Unstable& problem, IndefiniteTreatment policy) const {
    IntegratorSpec spec;
    spec.name = GetParam();
    spec.step_s = 1.0;
    spec.indefinite = policy;
    const auto stepper = integrate::make_stepper(problem.system, problem.state, spec);
    const StepResult result = stepper->advance_to(1000.0);
    EXPECT_TRUE(result.ok()) << result.message;
    EXPECT_EQ(problem.state.q().norm(), 0.0);
    // without any force no matrix was needed: one step from near the equilibrium
    if (stepper->counters().tangent_evaluations == 0) {
      problem.state.q().setConstant(1e-3);
      stepper->reinit(ReinitReason::kStateChanged);
      const StepResult beside = stepper->advance_to(1001.0);
      EXPECT_TRUE(beside.ok()) << beside.message;
    }
    EXPECT_FALSE(problem.term->definite) << "definite tangents are for one evaluation";
    return stepper->counters();
  }
};
INSTANTIATE_TEST_SUITE_P(Registry, Indefinite, testing::ValuesIn(implicit_methods()), registry_test_name);

TEST_P(Indefinite, AsksForDefiniteTangents) {
  Unstable problem(true);
  const StepperCounters c = counts(problem, IndefiniteTreatment::kProject);
  EXPECT_GT(c.indefinite, 0);
  EXPECT_EQ(c.projected, c.indefinite);
  EXPECT_GE(problem.term->definite_tangents, c.projected);
  EXPECT_GE(c.tangent_evaluations, 2 * c.projected) << "the true one, and the definite one";
}

TEST_P(Indefinite, FallsBackToLuWhereNoTangentIsDefinite) {
  Unstable problem(false);
  const StepperCounters c = counts(problem, IndefiniteTreatment::kProject);
  EXPECT_GT(c.indefinite, 0);
  EXPECT_EQ(c.projected, 0);
  EXPECT_GE(problem.term->definite_tangents, c.indefinite) << "asked for each time";
}

TEST_P(Indefinite, TakesLuAtOnceWhereAsked) {
  Unstable problem(true);
  const StepperCounters c = counts(problem, IndefiniteTreatment::kLu);
  EXPECT_GT(c.indefinite, 0);
  EXPECT_EQ(c.projected, 0);
  EXPECT_EQ(problem.term->definite_tangents, 0);
}

/// Two unit masses on x, coupled such that they are unstable together and stable against each other: along
/// (1, 1) q'' = 100 q, along (1, -1) q'' = -300 q. M + gamma^2 K has positive diagonal blocks at any gamma,
/// and is indefinite exactly for gamma > 0.1: only a solve with a right-hand side along (1, 1) detects it. A
/// push at kPushed provides such a right-hand side.
constexpr double kPushed = 500.0;
struct Toppling {
  struct Push final : ForceTerm, PsdProjectedTerm {
    LinearTerm leaning;
    MatX definite_K;
    bool on = false;
    long definite_tangents = 0;
    Push() : leaning(MatX::Zero(6, 6), MatX::Zero(6, 6), VecX::Zero(6)) {
      for (const int i : {1, 2, 4, 5}) leaning.K(i, i) = 100.0;
      definite_K = leaning.K;
      leaning.K(0, 0) = leaning.K(3, 3) = 100.0, leaning.K(0, 3) = leaning.K(3, 0) = -200.0;
      // the nearest positive semi-definite matrix
      definite_K(0, 0) = definite_K(3, 3) = 150.0, definite_K(0, 3) = definite_K(3, 0) = -150.0;
    }
    std::string_view name() const override { return "toppling"; }
    TermTraits traits() const override { return {}; }
    void add_pattern(PatternBuilder& pattern) const override { leaning.add_pattern(pattern); }
    void project_to_psd(bool definite) override { on = definite; }
    void add_force(const StateView& s, VecX& f) override {
      leaning.add_force(s, f);
      if (s.time >= kPushed) f[0] += 1e-3, f[3] += 1e-3;
    }
    void add_tangent(const StateView& s, double k, double d, BorderedMatrix& A) override {
      if (on && k != 0.0) ++definite_tangents;
      if (!on) return leaning.add_tangent(s, k, d, A);
      LinearTerm upright(definite_K, leaning.D, leaning.q0);
      upright.add_tangent(s, k, d, A);
    }
    void apply_tangent(const StateView&, double k, double, const VecX& x, VecX& y) override {
      y += k * ((on ? definite_K : leaning.K) * x);
    }
  };
  State state;
  System system;
  std::shared_ptr<Push> term = std::make_shared<Push>();
  Toppling() {
    const int id =
        state.insert(BlockSpec{.name = "masses", .q_size = 6, .u_size = 6}, VecX::Zero(6), VecX::Zero(6));
    system.add(std::static_pointer_cast<ForceTerm>(term));
    system.add(std::make_shared<NodalMass>(id, MatX::Identity(6, 6)));
    system.prepare(state.view());
  }
};

/// From rest, error-controlled steps grow far past gamma = 0.1 before the push; fixed steps are set beyond
/// it. A fixed step may fail: a Newton iteration with the definite matrix, 1, diverges for an equation of
/// slope 1 - 100 gamma^2 < 0.
StepperCounters pushed(Toppling& problem, IntegratorSpec spec) {
  spec.step_s = 1.0;
  const auto stepper = integrate::make_stepper(problem.system, problem.state, spec);
  const StepResult result = stepper->advance_to(kPushed + 1.0);
  EXPECT_TRUE(problem.state.q().allFinite());
  EXPECT_FALSE(problem.term->on) << "definite tangents are for one evaluation";
  EXPECT_TRUE(result.ok() || result.status == StepStatus::kNewtonFailed) << result.message;
  return stepper->counters();
}

TEST_P(Indefinite, MetWhileSolvingIsProjected) {
  for (const char* solver : {"pcg", "pcg-single", "pcg-two-level", "auto"}) {
    SCOPED_TRACE(solver);
    Toppling problem;
    const StepperCounters c = pushed(problem, {.name = GetParam(), .linear_solver = solver});
    EXPECT_GT(c.indefinite, 0);
    EXPECT_EQ(c.projected, c.indefinite);
    EXPECT_GE(problem.term->definite_tangents, c.projected);
  }
}

TEST_P(Indefinite, MetWhileSolvingIsAnsweredByLuWhereAsked) {
  Toppling problem;
  const StepperCounters c =
      pushed(problem, {.name = GetParam(), .indefinite = IndefiniteTreatment::kLu, .linear_solver = "pcg"});
  EXPECT_GT(c.indefinite, 0);
  EXPECT_EQ(c.projected, 0);
  EXPECT_EQ(problem.term->definite_tangents, 0);
}

// With a projected matrix the masses move in the direction of the push; with the exact one, as LU uses it, to
// the opposite side: (1 - 100) du = 1e-3.
TEST(LinearlyImplicitEuler, FollowsThePushByAnySolver) {
  VecX by_factor;
  for (const char* solver : {"cholmod", "pcg", "pcg-single", "pcg-two-level", "auto"}) {
    Toppling problem;
    problem.state.set_time(kPushed);
    const auto stepper =
        integrate::make_stepper(problem.system, problem.state,
                                {.name = "linearly-implicit-euler", .step_s = 1.0, .linear_solver = solver});
    ASSERT_TRUE(stepper->advance_to(kPushed + 1.0).ok());
    EXPECT_EQ(stepper->counters().projected, 1) << solver;
    EXPECT_NEAR(problem.state.u()[0], 1e-3, 1e-9) << solver << ": (1 + 0) du = 1e-3";
    if (by_factor.size() == 0) by_factor = problem.state.u();
    EXPECT_LT((problem.state.u() - by_factor).norm(), 1e-7 * by_factor.norm()) << solver;
  }
  Toppling problem;
  problem.state.set_time(kPushed);
  const auto stepper = integrate::make_stepper(
      problem.system, problem.state,
      {.name = "linearly-implicit-euler", .step_s = 1.0, .indefinite = IndefiniteTreatment::kLu});
  ASSERT_TRUE(stepper->advance_to(kPushed + 1.0).ok());
  EXPECT_NEAR(problem.state.u()[0], -1e-3 / 99.0, 1e-9);
}

}  // namespace
}  // namespace palpate
