// Struts beyond their critical load, and inverted or flattened bodies: their step matrices are indefinite.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

#include "palpate/core/named_enum.h"
#include "palpate/dynamics/system.h"
#include "palpate/fem/attachments.h"
#include "palpate/fem/soft_body.h"
#include "palpate/integrate/integrators.h"
#include "palpate/mesh/generators.h"

namespace palpate {
namespace {

using namespace dynamics;

constexpr double kLength = 1.0, kWidth = 0.1, kYoung = 1e6, kDensity = 1000.0;

/// Column along x with square section and nu = 0; all nodes of one end are held, under a dead load P on the
/// other end that uniform compression balances: F = diag(1 - e, 1, 1), R = I, P_xx = -E e, P = E A e, an
/// equilibrium at any e. Its tangent becomes indefinite at Euler's load P_cr = pi^2 E I / (4 L^2), e_cr =
/// P_cr / (E A) = pi^2 w^2 / (48 L^2) of a beam; linear tetrahedra are stiffer in bending, so that the mesh
/// has a higher load.
struct Strut {
  State state;
  System system;
  explicit Strut(double load_ratio) {
    const TetMesh mesh = mesh::box(Vec3(kLength, kWidth, kWidth), {20, 2, 2});
    const double e = load_ratio * M_PI * M_PI * kWidth * kWidth / (48.0 * kLength * kLength);
    Points x = mesh.nodes;
    x.row(0) = ((1.0 - e) * (x.row(0).array() + kLength / 2) - kLength / 2).matrix();
    const int n = static_cast<int>(x.cols());
    const int id = state.insert(BlockSpec{.name = "strut", .q_size = 3 * n, .u_size = 3 * n}, x.reshaped(),
                                VecX::Zero(3 * n));
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
    // load in equilibrium with this state: minus the elastic force on the free nodes
    VecX f = VecX::Zero(3 * n);
    body->add_force(state.view(), f);
    for (int dof : held) f[dof] = 0.0;
    system.add(fem::make_dead_load("end load", Points(-f.reshaped(3, n)), id));
    system.prepare(state.view());
  }
  /// Modes K phi = lambda M phi over the free directions [1/s^2], by increasing lambda; phi.M phi = 1.
  struct Modes {
    VecX lambda;
    MatX phi;
  };
  Modes modes() {
    BorderedMatrix K, M;
    system.step_matrix(state.view(), 0.0, 0.0, 1.0, K);
    system.step_matrix(state.view(), 1.0, 0.0, 0.0, M);
    const VecX scale = M.to_dense().diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::SelfAdjointEigenSolver<MatX> solved(scale.asDiagonal() * K.to_dense() * scale.asDiagonal());
    return {solved.eigenvalues(), scale.asDiagonal() * solved.eigenvectors()};
  }
  double smallest_eigenvalue() { return modes().lambda[0]; }
};

TEST(EulerStrut, IsStableBelowTheCriticalLoadAndNotWellAbove) {
  EXPECT_GT(Strut(0.9).smallest_eigenvalue(), 0.0);
  EXPECT_LT(Strut(4.0).smallest_eigenvalue(), 0.0);
}

// M + h^2 K is positive definite exactly if 1 + h^2 lambda > 0 for the smallest eigenvalue lambda of (K, M):
// with lambda = -sigma^2 < 0, if h < 1 / sigma. A body that moves along that mode at speed v leaves the step
// at v / (1 - (h sigma)^2), where the motion itself grows by e^(h sigma): the step follows the mode up to (h
// sigma)^2 = 0.1 and is projected beyond, whether or not the matrix is definite. It then keeps v, unless
// another part of the tangent reduces it. (A square section has two such modes with one rate.)
TEST(EulerStrut, StepGoesAlongTheUnstableModeUpToATenthOfItsMass) {
  const auto modes = Strut(4.0).modes();
  const double sigma = std::sqrt(-modes.lambda[0]);
  constexpr double kSpeed = 1e-9;
  for (const auto& [h_sigma, expected] : {std::pair{0.31, 0L}, std::pair{0.32, 1L}, std::pair{0.98, 1L}})
    for (const char* solver : {"cholmod", "pcg", "pcg-single", "pcg-two-level"})
      for (const auto policy : {IndefiniteTreatment::kProject, IndefiniteTreatment::kLu}) {
        Strut strut(4.0);
        strut.state.u() = kSpeed * modes.phi.col(0);
        const auto stepper = integrate::make_stepper(strut.system, strut.state,
                                                     {.name = "linearly-implicit-euler",
                                                      .step_s = h_sigma / sigma,
                                                      .indefinite = policy,
                                                      .linear_solver = solver,
                                                      .linear_rtol = 1e-8});
        ASSERT_TRUE(stepper->advance_to(h_sigma / sigma).ok());
        const std::string what = std::string(solver) + ", " + std::string(name_of(policy)) +
                                 ", h sigma = " + std::to_string(h_sigma);
        const bool projects = policy == IndefiniteTreatment::kProject && expected;
        EXPECT_EQ(stepper->counters().indefinite, projects ? 1 : 0) << what;
        EXPECT_EQ(stepper->counters().projected, projects ? 1 : 0) << what;
        const double speed = std::sqrt(2.0 * strut.system.kinetic_energy(strut.state.view()));
        if (projects)
          EXPECT_LE(speed, kSpeed * (1.0 + 1e-4)) << what;
        else
          EXPECT_NEAR(speed * (1.0 - h_sigma * h_sigma), kSpeed, 1e-3 * kSpeed) << what;
      }
}

// The matrix itself has a Cholesky factor up to (h sigma)^2 = 1.
TEST(EulerStrut, StepMatrixTurnsIndefiniteAtTheGrowthRate) {
  const double sigma = std::sqrt(-Strut(4.0).smallest_eigenvalue());
  const auto counts_of = [&](double h_sigma, const char* solver, IndefiniteTreatment policy) {
    Strut strut(4.0);
    const VecX q0 = strut.state.q();
    const IntegratorSpec spec{.name = "linearly-implicit-euler",
                              .step_s = h_sigma / sigma,
                              .indefinite = policy,
                              .linear_solver = solver};
    const auto stepper = integrate::make_stepper(strut.system, strut.state, spec);
    const StepResult result = stepper->advance_to(spec.step_s);
    EXPECT_TRUE(result.ok()) << result.message;
    EXPECT_LT((strut.state.q() - q0).norm(), 1e-9) << "an equilibrium, if an unstable one";
    EXPECT_TRUE(strut.state.u().allFinite());
    return std::pair{stepper->counters().indefinite, stepper->counters().projected};
  };
  EXPECT_EQ(counts_of(0.98, "cholmod", IndefiniteTreatment::kLu), std::pair(0L, 0L));
  EXPECT_EQ(counts_of(1.02, "cholmod", IndefiniteTreatment::kLu), std::pair(1L, 0L));
  EXPECT_EQ(counts_of(1.02, "cholmod", IndefiniteTreatment::kProject), std::pair(1L, 1L));
  // PCG finds negative curvature only along directions present in the right-hand side
  for (const auto policy : {IndefiniteTreatment::kProject, IndefiniteTreatment::kLu})
    counts_of(1.02, "pcg", policy);
}

/// A cube with one end held and the nodes of its free half mirrored through the middle plane: all elements in
/// between are inverted.
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
    const int id = state.insert(BlockSpec{.name = "cube", .q_size = 3 * n, .u_size = 3 * n}, x.reshaped(),
                                VecX::Zero(3 * n));
    fem::Material material{.youngs_modulus = 1e5, .poissons_ratio = 0.4, .density = kDensity};
    system.add(std::static_pointer_cast<ForceTerm>(
        std::make_shared<fem::SoftBody>("cube", mesh, material, fem::SoftBodyOptions{}, id)));
    system.add(fem::make_lumped_mass(mesh, kDensity, id));
    VecX x0(static_cast<Eigen::Index>(held.size()));
    for (std::size_t i = 0; i < held.size(); ++i) x0[static_cast<Eigen::Index>(i)] = state.q()[held[i]];
    system.add(fem::make_fixed(held, x0));
    system.prepare(state.view());
  }
};

TEST(InvertedElements, GiveAFiniteStepByEitherPolicy) {
  for (const char* solver : {"cholmod", "pcg", "pcg-single", "pcg-two-level", "auto"})
    for (const auto policy : {IndefiniteTreatment::kProject, IndefiniteTreatment::kLu}) {
      Mirrored cube;
      ASSERT_GE(cube.system.inspect(cube.state.view()).first.element, 0) << "the mesh is inside out";
      IntegratorSpec spec{
          .name = "linearly-implicit-euler", .step_s = 0.01, .indefinite = policy, .linear_solver = solver};
      const auto stepper = integrate::make_stepper(cube.system, cube.state, spec);
      const double energy = cube.system.potential_energy(cube.state.view());
      const StepResult result = stepper->advance_to(0.01);
      ASSERT_TRUE(result.ok()) << result.message;
      EXPECT_TRUE(cube.state.q().allFinite() && cube.state.u().allFinite());
      const StepperCounters& c = stepper->counters();
      EXPECT_EQ(c.indefinite, 1) << solver << ", " << name_of(policy);
      EXPECT_EQ(c.projected, policy == IndefiniteTreatment::kProject ? 1 : 0);
      if (policy == IndefiniteTreatment::kProject) {
        EXPECT_LT(cube.system.potential_energy(cube.state.view()), energy)
            << "a definite matrix gives a direction of descent";
      }
    }
}

/// A free damped cube whose nodes are collapsed onto a line, with random offsets of a nanometre.
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
    const int id = state.insert(BlockSpec{.name = "cube", .q_size = 3 * n, .u_size = 3 * n}, x.reshaped(),
                                VecX::Zero(3 * n));
    fem::Material material{.youngs_modulus = 1e4, .poissons_ratio = 0.4, .density = kDensity};
    material.mass_damping = 1.0;
    material.stiffness_damping = 4e-3;
    system.add(std::static_pointer_cast<ForceTerm>(
        std::make_shared<fem::SoftBody>("cube", mesh, material, fem::SoftBodyOptions{}, id)));
    system.add(fem::make_lumped_mass(mesh, kDensity, id));
    system.prepare(state.view());
  }
};

// A moving body's step gains no energy, whether its matrix is reassembled in one pass or as a whole: its
// right-hand side is h (f - K_p h u0) with the same projected tangent. With the exact tangent, whose
// stiffness the flat elements change without bound, the body would leave at 2e4 m/s.
TEST(InvertedElements, AreProjectedAlikeInOnePass) {
  const auto step_by = [](const char* solver, StepperCounters& c) {
    Crushed cube(1);
    for (Eigen::Index i = 0; i < cube.state.u().size(); ++i)
      cube.state.u()[i] = 0.3 * std::sin(1.0 + 2.0 * static_cast<double>(i));
    const auto stepper = integrate::make_stepper(
        cube.system, cube.state,
        {.name = "linearly-implicit-euler", .step_s = 5e-3, .linear_solver = solver, .linear_rtol = 1e-5});
    const auto energy = [&] {
      return cube.system.potential_energy(cube.state.view()) + cube.system.kinetic_energy(cube.state.view());
    };
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

/// Largest energy of the crushed cube within 0.5 s, relative to its initial energy, over five seeds; `sum`
/// accumulates the counts.
double most_energy(const std::string& solver, double rtol, IndefiniteTreatment policy, StepperCounters& sum) {
  double most = 0.0;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Crushed cube(seed);
    const IntegratorSpec spec{.name = "linearly-implicit-euler",
                              .step_s = 5e-3,
                              .indefinite = policy,
                              .linear_solver = solver,
                              .linear_rtol = rtol};
    const auto stepper = integrate::make_stepper(cube.system, cube.state, spec);
    const auto energy = [&] {
      return cube.system.potential_energy(cube.state.view()) + cube.system.kinetic_energy(cube.state.view());
    };
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

// A released crushed body must not gain energy, whether its solver detects the indefinite matrices when it
// factors or while it solves. With LU, which follows the linear force model to its saddle point, it gains
// energy.
TEST(InvertedElements, GainNoEnergyByAnySolver) {
  StepperCounters by_factor, by_lu;
  const double expected = most_energy("cholmod", 1e-8, IndefiniteTreatment::kProject, by_factor);
  EXPECT_LT(expected, 1.0);
  EXPECT_GT(by_factor.projected, 0);
  EXPECT_GT(most_energy("cholmod", 1e-8, IndefiniteTreatment::kLu, by_lu), 2.0);
  for (const char* solver : {"pcg", "pcg-single", "pcg-two-level", "auto"})
    for (const double rtol : {1e-3, 1e-8}) {
      StepperCounters c;
      EXPECT_NEAR(most_energy(solver, rtol, IndefiniteTreatment::kProject, c), expected, rtol)
          << solver << ", " << rtol;
      EXPECT_EQ(c.indefinite, by_factor.indefinite) << solver << ", " << rtol;
      EXPECT_EQ(c.projected, c.indefinite) << solver << ", " << rtol;
      EXPECT_EQ(c.unconverged, 0) << solver << ", " << rtol;
    }
}

/// A free damped cube with random node positions within its size and random velocities.
struct ThrownApart {
  State state;
  System system;
  explicit ThrownApart(unsigned seed) {
    const TetMesh mesh = mesh::box(Vec3::Constant(0.1), {1, 1, 1});
    const int n = static_cast<int>(mesh.nodes.cols());
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(-0.05, 0.05), speed(-3.0, 3.0);
    VecX x(3 * n), u(3 * n);
    for (double& value : x) value = place(random);
    for (double& value : u) value = speed(random);
    const int id = state.insert(BlockSpec{.name = "cube", .q_size = 3 * n, .u_size = 3 * n}, x, u);
    fem::Material material{.youngs_modulus = 1e4, .poissons_ratio = 0.4, .density = kDensity};
    system.add(std::static_pointer_cast<ForceTerm>(
        std::make_shared<fem::SoftBody>("cube", mesh, material, fem::SoftBodyOptions{}, id)));
    system.add(fem::make_lumped_mass(mesh, kDensity, id));
    system.prepare(state.view());
  }
  double speed() { return std::sqrt(2.0 * system.kinetic_energy(state.view())); }
};

// No step is faster than 1/(1 - eta) times the step of the same nodes without stiffness, u0 + h M^-1 f, for
// any tangent and any solver. With the unprojected tangent, as LU uses it, some are ten times faster and
// more: their matrices are barely definite.
TEST(ThrownApart, NoStepIsFasterThanTheForcesPush) {
  constexpr double kStep = 5e-3, kMost = 1.0 / 0.9, kSolved = 1e-6;
  const auto fastest = [&](const char* solver, IndefiniteTreatment policy, long& projected) {
    double most = 0.0;
    for (unsigned seed = 1; seed <= 100; ++seed) {
      ThrownApart cube(seed);
      const auto stepper = integrate::make_stepper(cube.system, cube.state,
                                                   {.name = "linearly-implicit-euler",
                                                    .step_s = kStep,
                                                    .indefinite = policy,
                                                    .linear_solver = solver,
                                                    .linear_rtol = 0.1 * kSolved});
      for (int i = 1; i <= 20; ++i) {
        VecX f;
        cube.system.force(cube.state.view(), f);
        const VecX& mass = cube.system.nodal_mass();
        const VecX pushed = cube.state.u() + kStep * f.cwiseQuotient(mass);
        const double bound = std::sqrt(pushed.dot(mass.cwiseProduct(pushed)));
        EXPECT_TRUE(stepper->advance_to(i * kStep).ok()) << solver << ", seed " << seed;
        most = std::max(most, cube.speed() / bound);
      }
      projected += stepper->counters().projected;
    }
    return most;
  };
  long projected = 0, none = 0;
  EXPECT_GT(fastest("cholmod", IndefiniteTreatment::kLu, none), 10.0);
  EXPECT_EQ(none, 0);
  for (const char* solver : {"cholmod", "pcg", "pcg-single", "pcg-two-level", "auto"}) {
    projected = 0;
    EXPECT_LE(fastest(solver, IndefiniteTreatment::kProject, projected), kMost * (1.0 + kSolved)) << solver;
    EXPECT_GT(projected, 0) << solver;
  }
}

}  // namespace
}  // namespace palpate
