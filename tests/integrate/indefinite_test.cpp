#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

#include "integrate/condensed_newton.h"
#include "integrate/fakes.h"
#include "integrate/registry_test_name.h"
#include "palpate/fem/attachments.h"
#include "palpate/fem/soft_body.h"
#include "palpate/mesh/generators.h"

namespace palpate {
namespace {

using namespace fakes;

/// f = -K (q - q0), with a definite stand-in for K where there is one.
struct Buckling final : ForceTerm {
  MatX K, definite_K;
  bool definite = false;
  long definite_tangents = 0;
  Buckling(MatX k, MatX stand_in) : K(std::move(k)), definite_K(std::move(stand_in)) {}
  std::string_view name() const override { return "buckling"; }
  TermTraits traits() const override { return {}; }
  void set_definite(bool on) override { definite = on; }
  void add_force(const StateView& s, VecX& f) override { f -= K * s.q; }
  void add_tangent(const StateView&, double k, double, BorderedMatrix& A) override {
    if (definite && k != 0.0) ++definite_tangents;
    for (int i = 0; i < K.rows() / 3; ++i) A.body.add(A.body.slot(i, i), k * (definite ? definite_K : K).block<3, 3>(3 * i, 3 * i));
  }
  void apply_tangent(const StateView&, double k, double, const VecX& x, VecX& y) override { y += k * ((definite ? definite_K : K) * x); }
};

/// Two unit masses without coupling at an unstable equilibrium: q'' = 100 q along x of the first, stable along the rest.
/// M + gamma^2 K is indefinite exactly for gamma > 0.1.
struct Unstable {
  State state;
  System system;
  std::shared_ptr<Buckling> term;
  explicit Unstable(bool has_definite_tangent) {
    const int id = state.insert(BlockSpec{.name = "masses", .q_size = 6, .u_size = 6}, VecX::Zero(6), VecX::Zero(6));
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
  /// From rest at the equilibrium there is no error to control and no force: adaptive steps grow past gamma = 0.1, and the fixed ones are given so.
  StepperCounters counts(Unstable& problem, const std::string& policy) const {
    IntegratorSpec spec;
    spec.name = GetParam();
    spec.step_s = 1.0;
    spec.indefinite = policy;
    const auto stepper = integrate::make_stepper(problem.system, problem.state, spec);
    const StepResult result = stepper->advance_to(1000.0);
    EXPECT_TRUE(result.ok()) << result.message;
    EXPECT_EQ(problem.state.q().norm(), 0.0);
    if (stepper->counters().tangent_evaluations == 0) {  // saw that no force was left, and asked for no matrix: one step from beside the equilibrium
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
  const StepperCounters c = counts(problem, "project");
  EXPECT_GT(c.indefinite, 0);
  EXPECT_EQ(c.projected, c.indefinite);
  EXPECT_GE(problem.term->definite_tangents, c.projected);
  EXPECT_GE(c.tangent_evaluations, 2 * c.projected) << "the true one, and the definite one";
}

TEST_P(Indefinite, FallsBackToLuWhereNoTangentIsDefinite) {
  Unstable problem(false);
  const StepperCounters c = counts(problem, "project");
  EXPECT_GT(c.indefinite, 0);
  EXPECT_EQ(c.projected, 0);
  EXPECT_GE(problem.term->definite_tangents, c.indefinite) << "asked for each time";
}

TEST_P(Indefinite, TakesLuAtOnceWhereAsked) {
  Unstable problem(true);
  const StepperCounters c = counts(problem, "lu");
  EXPECT_GT(c.indefinite, 0);
  EXPECT_EQ(c.projected, 0);
  EXPECT_EQ(problem.term->definite_tangents, 0);
}

/// Two unit masses on x, joined so that together they topple and against each other they are held: along (1, 1) q'' = 100 q, along (1, -1) q'' = -300 q.
/// M + gamma^2 K has positive blocks on its diagonal at any gamma, and is indefinite exactly for gamma > 0.1: only a solve can tell, of a right-hand side along (1, 1).
/// Such a one comes with a push at kPushed.
constexpr double kPushed = 500.0;
struct Toppling {
  struct Push final : ForceTerm {
    LinearTerm leaning;
    MatX definite_K;
    bool on = false;
    long definite_tangents = 0;
    Push() : leaning(MatX::Zero(6, 6), MatX::Zero(6, 6), VecX::Zero(6)) {
      for (const int i : {1, 2, 4, 5}) leaning.K(i, i) = 100.0;
      definite_K = leaning.K;
      leaning.K(0, 0) = leaning.K(3, 3) = 100.0, leaning.K(0, 3) = leaning.K(3, 0) = -200.0;
      definite_K(0, 0) = definite_K(3, 3) = 150.0, definite_K(0, 3) = definite_K(3, 0) = -150.0;  // the nearest positive semi-definite one
    }
    std::string_view name() const override { return "toppling"; }
    TermTraits traits() const override { return {}; }
    void add_pattern(PatternBuilder& pattern) const override { leaning.add_pattern(pattern); }
    void set_definite(bool definite) override { on = definite; }
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
    void apply_tangent(const StateView&, double k, double, const VecX& x, VecX& y) override { y += k * ((on ? definite_K : leaning.K) * x); }
  };
  State state;
  System system;
  std::shared_ptr<Push> term = std::make_shared<Push>();
  Toppling() {
    const int id = state.insert(BlockSpec{.name = "masses", .q_size = 6, .u_size = 6}, VecX::Zero(6), VecX::Zero(6));
    system.add(std::static_pointer_cast<ForceTerm>(term));
    system.add(std::make_shared<NodalMass>(id, MatX::Identity(6, 6)));
    system.prepare(state.view());
  }
};

/// From rest the steps of error control grow far past gamma = 0.1, and meet the push with it; fixed ones are given so.  A fixed step may fail: a Newton iteration by
/// the definite matrix, 1, for an equation of slope 1 - 100 gamma^2 < 0 goes away from its solution.
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
  const StepperCounters c = pushed(problem, {.name = GetParam(), .indefinite = "lu", .linear_solver = "pcg"});
  EXPECT_GT(c.indefinite, 0);
  EXPECT_EQ(c.projected, 0);
  EXPECT_EQ(problem.term->definite_tangents, 0);
}

// With a projected matrix the masses go where the push sends them; with the true one, LU's, to the other side: (1 - 100) du = 1e-3.
TEST(LinearlyImplicitEuler, FollowsThePushByAnySolver) {
  VecX by_factor;
  for (const char* solver : {"cholmod", "pcg", "pcg-single", "pcg-two-level", "auto"}) {
    Toppling problem;
    problem.state.set_time(kPushed);
    const auto stepper = integrate::make_stepper(problem.system, problem.state, {.name = "linearly-implicit-euler", .step_s = 1.0, .linear_solver = solver});
    ASSERT_TRUE(stepper->advance_to(kPushed + 1.0).ok());
    EXPECT_EQ(stepper->counters().projected, 1) << solver;
    EXPECT_NEAR(problem.state.u()[0], 1e-3, 1e-9) << solver << ": (1 + 0) du = 1e-3";
    if (by_factor.size() == 0) by_factor = problem.state.u();
    EXPECT_LT((problem.state.u() - by_factor).norm(), 1e-7 * by_factor.norm()) << solver;
  }
  Toppling problem;
  problem.state.set_time(kPushed);
  const auto stepper = integrate::make_stepper(problem.system, problem.state, {.name = "linearly-implicit-euler", .step_s = 1.0, .indefinite = "lu"});
  ASSERT_TRUE(stepper->advance_to(kPushed + 1.0).ok());
  EXPECT_NEAR(problem.state.u()[0], -1e-3 / 99.0, 1e-9);
}

// Newton's matrix of the residual form, against the dense matrix that the header derives it from.
TEST(CondensedNewton, SolvesTheResidualForm) {
  Chain chain(0.3);
  IntegratorSpec spec;
  integrate::CondensedNewton newton(chain.system, integrate::make_linear_solver("cholmod"), spec);
  StepperCounters counters;
  newton.evaluate(chain.state.view(), counters);
  const Eigen::Index n = chain.state.layout().u_size;
  const double gamma = 0.07;
  ASSERT_EQ(newton.factor(gamma), SolveStatus::kOk);
  MatX J(2 * n, 2 * n);
  J << MatX::Identity(n, n) / gamma, -MatX::Identity(n, n), chain.term->K, chain.term->D + MatX::Identity(n, n) / gamma;
  const VecX r = VecX::LinSpaced(2 * n, -1.0, 2.0), expected = J.partialPivLu().solve(r);
  VecX d(2 * n);
  ASSERT_EQ(newton.solve_residual_form(chain.state.layout(), chain.state.q().data(), r.data(), r.data() + n, d.data(), d.data() + n), SolveStatus::kOk);
  EXPECT_LT((d - expected).norm(), 1e-12 * expected.norm());
}

TEST(CondensedNewton, FactorsOnlyWhatChanged) {
  Chain chain;
  integrate::CondensedNewton newton(chain.system, integrate::make_linear_solver("cholmod"), {});
  StepperCounters counters;
  newton.evaluate(chain.state.view(), counters);
  for (const double gamma : {0.1, 0.1, 0.1, 0.2, 0.2}) ASSERT_EQ(newton.factor(gamma), SolveStatus::kOk);
  EXPECT_EQ(newton.solver().counters().factorisations, 2);
  EXPECT_EQ(counters.tangent_evaluations, 1);
}

/// Keeps the positions that it is given with a matrix.
struct PositionsKept final : LinearSolver {
  VecX& kept;
  SolverCounters none;
  explicit PositionsKept(VecX& to) : kept(to) {}
  std::string name() const override { return "positions"; }
  bool supports_unsymmetric() const override { return true; }
  SolveStatus factor(const BorderedMatrix& A) override {
    kept = A.positions;
    return SolveStatus::kOk;
  }
  SolveStatus solve(const MatX&, MatX&) override { return SolveStatus::kSingular; }
  SolveStatus solve(const VecX&, VecX&) override { return SolveStatus::kSingular; }
  const SolverCounters& counters() const override { return none; }
};

// Preconditioners turn their rigid motions with the body.
TEST(CondensedNewton, TellsWhereTheNodesAre) {
  Chain chain;
  VecX seen;
  integrate::CondensedNewton newton(chain.system, std::make_unique<PositionsKept>(seen), {});
  StepperCounters counters;
  for (const double shift : {0.0, 0.25}) {
    chain.state.q().array() += shift;
    newton.evaluate(chain.state.view(), counters);
    ASSERT_EQ(newton.factor(0.1), SolveStatus::kOk);
    ASSERT_GT(seen.size(), 0);
    EXPECT_EQ(seen, VecX(chain.state.q().head(seen.size())));
  }
}

// --- soft bodies -----------------------------------------------------------------------------------------------------

constexpr double kLength = 1.0, kWidth = 0.1, kYoung = 1e6, kDensity = 1000.0;

/// Column along x of square section, nu = 0, all nodes of one end held, under a dead load P on the other that is met by uniform compression:
/// F = diag(1 - e, 1, 1), R = I, P_xx = -E e, P = E A e: an equilibrium at any e.  Its tangent loses definiteness at Euler's load
///   P_cr = pi^2 E I / (4 L^2),  e_cr = P_cr / (E A) = pi^2 w^2 / (48 L^2)
/// of a beam; linear tetrahedra are stiffer in bending, so that of the mesh lies above.
struct Strut {
  State state;
  System system;
  explicit Strut(double load_ratio) {
    const TetMesh mesh = mesh::box(Vec3(kLength, kWidth, kWidth), {20, 2, 2});
    const double e = load_ratio * M_PI * M_PI * kWidth * kWidth / (48.0 * kLength * kLength);
    Points x = mesh.nodes;
    x.row(0) = ((1.0 - e) * (x.row(0).array() + kLength / 2) - kLength / 2).matrix();
    const int n = static_cast<int>(x.cols());
    const int id = state.insert(BlockSpec{.name = "strut", .q_size = 3 * n, .u_size = 3 * n}, x.reshaped(), VecX::Zero(3 * n));
    fem::Material material{.youngs_modulus = kYoung, .poissons_ratio = 0.0, .density = kDensity};
    const auto body = std::make_shared<fem::SoftBody>("strut", mesh, material, fem::SoftBodyOptions{}, id);
    system.add(std::static_pointer_cast<ForceTerm>(body));
    std::vector<int> held;
    for (int i = 0; i < n; ++i)
      if (mesh.nodes(0, i) < -kLength / 2 + 1e-9)
        for (int axis = 0; axis < 3; ++axis) held.push_back(3 * i + axis);
    system.add(fem::make_lumped_mass(mesh, kDensity, id));
    VecX x0(static_cast<Eigen::Index>(held.size()));
    for (std::size_t i = 0; i < held.size(); ++i) x0[static_cast<Eigen::Index>(i)] = state.q()[held[i]];
    system.add(fem::make_fixed(held, x0));
    // the load that holds this state: minus the elastic force on the nodes that are free
    VecX f = VecX::Zero(3 * n);
    body->add_force(state.view(), f);
    for (int dof : held) f[dof] = 0.0;
    system.add(fem::make_dead_load("end load", Points(-f.reshaped(3, n)), id));
    system.prepare(state.view());
  }
  /// Smallest eigenvalue of K phi = lambda M phi over the free directions [1/s^2].
  double smallest_eigenvalue() {
    BorderedMatrix K, M;
    system.step_matrix(state.view(), 0.0, 0.0, 1.0, K);
    system.step_matrix(state.view(), 1.0, 0.0, 0.0, M);
    const VecX scale = M.to_dense().diagonal().cwiseSqrt().cwiseInverse();
    return Eigen::SelfAdjointEigenSolver<MatX>(scale.asDiagonal() * K.to_dense() * scale.asDiagonal(), Eigen::EigenvaluesOnly).eigenvalues()[0];
  }
};

TEST(EulerStrut, IsStableBelowTheCriticalLoadAndNotWellAbove) {
  EXPECT_GT(Strut(0.9).smallest_eigenvalue(), 0.0);
  EXPECT_LT(Strut(4.0).smallest_eigenvalue(), 0.0);
}

// M + h^2 K is positive definite exactly when 1 + h^2 lambda > 0 for the smallest eigenvalue lambda of (K, M): with lambda = -sigma^2 < 0, when h < 1 / sigma.
TEST(EulerStrut, StepMatrixTurnsIndefiniteAtTheGrowthRate) {
  const double sigma = std::sqrt(-Strut(4.0).smallest_eigenvalue());
  for (const auto& [h_sigma, expected] : {std::pair{0.98, 0L}, std::pair{1.02, 1L}})
    for (const char* solver : {"cholmod", "pcg"}) {
      for (const char* policy : {"project", "lu"}) {
        Strut strut(4.0);
        const VecX q0 = strut.state.q();
        IntegratorSpec spec{.name = "linearly-implicit-euler", .step_s = h_sigma / sigma, .indefinite = policy, .linear_solver = solver};
        const auto stepper = integrate::make_stepper(strut.system, strut.state, spec);
        const StepResult result = stepper->advance_to(spec.step_s);
        ASSERT_TRUE(result.ok()) << result.message;
        EXPECT_LT((strut.state.q() - q0).norm(), 1e-9) << "an equilibrium, if an unstable one";
        EXPECT_TRUE(strut.state.u().allFinite());
        if (solver != std::string("cholmod")) continue;  // PCG meets a direction of negative curvature only where the right-hand side has one
        EXPECT_EQ(stepper->counters().indefinite, expected) << policy << ", h sigma = " << h_sigma;
        EXPECT_EQ(stepper->counters().projected, policy == std::string("project") ? expected : 0);
      }
    }
}

/// A cube, one end held, the nodes of its free half mirrored through the middle plane: every element between is inside out.
struct Mirrored {
  State state;
  System system;
  Mirrored() {
    const TetMesh mesh = mesh::box(Vec3::Constant(0.1), {4, 4, 4});
    const int n = static_cast<int>(mesh.nodes.cols());
    Points x = mesh.nodes;
    std::vector<int> held;
    for (int i = 0; i < n; ++i) {
      x(0, i) = std::min(x(0, i), -0.6 * x(0, i));
      if (x(0, i) < -0.05 + 1e-9)
        for (int axis = 0; axis < 3; ++axis) held.push_back(3 * i + axis);
    }
    const int id = state.insert(BlockSpec{.name = "cube", .q_size = 3 * n, .u_size = 3 * n}, x.reshaped(), VecX::Zero(3 * n));
    fem::Material material{.youngs_modulus = 1e5, .poissons_ratio = 0.4, .density = kDensity};
    system.add(std::static_pointer_cast<ForceTerm>(std::make_shared<fem::SoftBody>("cube", mesh, material, fem::SoftBodyOptions{}, id)));
    system.add(fem::make_lumped_mass(mesh, kDensity, id));
    VecX x0(static_cast<Eigen::Index>(held.size()));
    for (std::size_t i = 0; i < held.size(); ++i) x0[static_cast<Eigen::Index>(i)] = state.q()[held[i]];
    system.add(fem::make_fixed(held, x0));
    system.prepare(state.view());
  }
};

TEST(InvertedElements, GiveAFiniteStepByEitherPolicy) {
  for (const char* solver : {"cholmod", "pcg", "pcg-single", "pcg-two-level", "auto"})
    for (const char* policy : {"project", "lu"}) {
      Mirrored cube;
      ASSERT_GE(cube.system.inspect(cube.state.view()).first.element, 0) << "the mesh is inside out";
      IntegratorSpec spec{.name = "linearly-implicit-euler", .step_s = 0.01, .indefinite = policy, .linear_solver = solver};
      const auto stepper = integrate::make_stepper(cube.system, cube.state, spec);
      const double energy = cube.system.potential_energy(cube.state.view());
      const StepResult result = stepper->advance_to(0.01);
      ASSERT_TRUE(result.ok()) << result.message;
      EXPECT_TRUE(cube.state.q().allFinite() && cube.state.u().allFinite());
      const StepperCounters& c = stepper->counters();
      EXPECT_EQ(c.indefinite, 1) << solver << ", " << policy;
      EXPECT_EQ(c.projected, policy == std::string("project") ? 1 : 0);
      if (policy == std::string("project")) {
        EXPECT_LT(cube.system.potential_energy(cube.state.view()), energy) << "a definite matrix gives a direction of descent";
      }
    }
}

/// A free damped cube whose nodes are crushed onto a line, but for a nanometre at random.
struct Crushed {
  State state;
  System system;
  explicit Crushed(unsigned seed) {
    const TetMesh mesh = mesh::box(Vec3::Constant(0.1), {2, 2, 2});
    const int n = static_cast<int>(mesh.nodes.cols());
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> nanometre(-1e-9, 1e-9);
    Points x = mesh.nodes;
    x.bottomRows<2>().setZero();
    for (double& value : x.reshaped()) value += nanometre(random);
    const int id = state.insert(BlockSpec{.name = "cube", .q_size = 3 * n, .u_size = 3 * n}, x.reshaped(), VecX::Zero(3 * n));
    fem::Material material{.youngs_modulus = 1e4, .poissons_ratio = 0.4, .density = kDensity};
    material.mass_damping = 1.0;
    material.stiffness_damping = 4e-3;
    system.add(std::static_pointer_cast<ForceTerm>(std::make_shared<fem::SoftBody>("cube", mesh, material, fem::SoftBodyOptions{}, id)));
    system.add(fem::make_lumped_mass(mesh, kDensity, id));
    system.prepare(state.view());
  }
};

// A moving body's step gains no energy, whether its matrix is made again in one pass or as a whole: its right-hand side is h (f - K_p h u0) by the same tangent.  By the true one,
// which the flat elements make stiffer and softer without bound, it would leave at 2e4 m/s.
TEST(InvertedElements, AreProjectedAlikeInOnePass) {
  const auto step_by = [](const char* solver, StepperCounters& c) {
    Crushed cube(1);
    for (Eigen::Index i = 0; i < cube.state.u().size(); ++i) cube.state.u()[i] = 0.3 * std::sin(1.0 + 2.0 * static_cast<double>(i));
    const auto stepper = integrate::make_stepper(cube.system, cube.state, {.name = "linearly-implicit-euler", .step_s = 5e-3, .linear_solver = solver, .linear_rtol = 1e-5});
    const auto energy = [&] { return cube.system.potential_energy(cube.state.view()) + cube.system.kinetic_energy(cube.state.view()); };
    const double start = energy();
    EXPECT_TRUE(stepper->advance_to(5e-3).ok()) << solver;
    EXPECT_LT(energy(), start) << solver;
    c = stepper->counters();
    return VecX(cube.state.u());
  };
  StepperCounters c;
  const VecX expected = step_by("cholmod", c);
  ASSERT_EQ(c.projected, 1);
  for (const char* solver : {"pcg-single", "pcg-two-level", "auto"}) {
    EXPECT_LT((step_by(solver, c) - expected).norm(), 1e-4 * expected.norm()) << solver;
    EXPECT_EQ(c.indefinite, 1) << solver;
    EXPECT_EQ(c.projected, 1) << solver;
    EXPECT_EQ(c.tangent_evaluations, 2) << solver << ": the whole matrix was not asked for";
  }
}

/// What becomes of the crushed cube of five seeds in 0.5 s: the most energy that it ever had, over that at the start; counts of all.
double most_energy(const std::string& solver, double rtol, const std::string& policy, StepperCounters& sum) {
  double most = 0.0;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Crushed cube(seed);
    const IntegratorSpec spec{.name = "linearly-implicit-euler", .step_s = 5e-3, .indefinite = policy, .linear_solver = solver, .linear_rtol = rtol};
    const auto stepper = integrate::make_stepper(cube.system, cube.state, spec);
    const auto energy = [&] { return cube.system.potential_energy(cube.state.view()) + cube.system.kinetic_energy(cube.state.view()); };
    const double start = energy();
    for (int i = 1; i <= 100; ++i) {
      const StepResult result = stepper->advance_to(i * spec.step_s);
      EXPECT_TRUE(result.ok()) << solver << ": " << result.message;
      most = std::max(most, energy() / start);
    }
    sum.indefinite += stepper->counters().indefinite;
    sum.projected += stepper->counters().projected;
    sum.unconverged += stepper->counters().unconverged;
  }
  return most;
}

// Let go, a crushed body may not gain energy, whether its solver meets the indefinite matrices when it factors or while it solves.  By LU, which follows the linear force model
// to its saddle, it does.
TEST(InvertedElements, GainNoEnergyByAnySolver) {
  StepperCounters by_factor, by_lu;
  const double expected = most_energy("cholmod", 1e-8, "project", by_factor);
  EXPECT_LT(expected, 1.0);
  EXPECT_GT(by_factor.projected, 0);
  EXPECT_GT(most_energy("cholmod", 1e-8, "lu", by_lu), 2.0);
  for (const char* solver : {"pcg", "pcg-single", "pcg-two-level", "auto"})
    for (const double rtol : {1e-3, 1e-8}) {
      StepperCounters c;
      EXPECT_NEAR(most_energy(solver, rtol, "project", c), expected, rtol) << solver << ", " << rtol;
      EXPECT_EQ(c.indefinite, by_factor.indefinite) << solver << ", " << rtol;
      EXPECT_EQ(c.projected, c.indefinite) << solver << ", " << rtol;
      EXPECT_EQ(c.unconverged, 0) << solver << ", " << rtol;
    }
}

}  // namespace
}  // namespace palpate
