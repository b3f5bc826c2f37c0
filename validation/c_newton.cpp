#include <cmath>
#include <functional>
#include <random>

#include <Eigen/LU>

#include "cases.h"
#include "palpate/fem/nodal_dilatation.h"
#include "palpate/mesh/generators.h"
#include "statics.h"

// Problem: convergence of Newton's method for two problems. Statics: f(x) + load = 0, a beam bent by about 60
// degrees. One step of backward Euler, H long, for a free body that spins and is deformed: M (v - v0) - H
// f(x0 + H v, v) = 0 with the matrix M + H D + H^2 K.
//
// Exact answer (Kantorovich; Dennis and Schnabel, Numerical Methods for Unconstrained Optimization, 5.2 and
// 5.4): with the derivative of the residual the method converges quadratically, r_(k+1) <= C r_k^2, with any
// other matrix close to it linearly. Exact: the exact tangent, with damping only if the unsymmetric part of
// its derivative by position is kept. Inexact: the warped tangent, or this part dropped.
//
// Measured: the exponent, which is the slope of log r_(k+1) over log r_k for consecutive residuals clear of
// rounding, from starts around one solution. Limit: 0.15 from 2 or 1.

namespace palpate::validation {
namespace {

struct Problem {
  std::function<VecX(const VecX&)> residual;
  std::function<MatX(const VecX&)> matrix;
  VecX solution;  ///< Initially a guess.
  double size;    ///< Norm scale of a perturbation to start from.
};

/// Runs Newton's method from z down to rounding and returns the residual norms.
std::vector<double> newton(const Problem& p, VecX z, int steps) {
  std::vector<double> r;
  Eigen::PartialPivLU<MatX> factor;
  for (int k = 0; k < steps; ++k) {
    const VecX g = p.residual(z);
    r.push_back(g.norm());
    factor.compute(p.matrix(z));
    z -= factor.solve(g);
  }
  return r;
}

/// Starts around the solution at halved distances and returns the slope within each generation (first pair,
/// second pair, ...), pooled, as the constant differs between generations.
double exponent(const Problem& p) {
  constexpr int kStarts = 6, kSteps = 8;
  std::mt19937 engine(71);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const VecX w = VecX::NullaryExpr(p.solution.size(), [&] { return uniform(engine); });
  std::vector<std::vector<double>> runs;
  for (int k = 0; k < kStarts; ++k)
    runs.push_back(newton(p, p.solution + p.size * std::pow(0.5, k) * w, kSteps));
  const double rounding = 100.0 * p.residual(p.solution).norm();
  double xy = 0.0, xx = 0.0;
  for (std::size_t generation = 0; generation + 1 < kSteps; ++generation) {
    std::vector<double> before, after;
    for (const auto& r : runs)
      if (r[generation + 1] > rounding) {
        before.push_back(std::log(r[generation]));
        after.push_back(std::log(r[generation + 1]));
      }
    if (before.size() < 3) break;
    const Eigen::Map<const Eigen::ArrayXd> x(before.data(), static_cast<Eigen::Index>(before.size())),
        y(after.data(), x.size());
    xy += ((x - x.mean()) * (y - y.mean())).sum();
    xx += (x - x.mean()).square().sum();
  }
  return xy / xx;
}

/// Body and state for dense algebra.
class Body {
 public:
  Body(const TetMesh& rest, const fem::Material& m, const fem::SoftBodyOptions& options)
      : rest_(rest),
        state_(static_cast<int>(3 * rest.nodes.cols()), static_cast<int>(3 * rest.nodes.cols())),
        zero_(VecX::Zero(3 * rest.nodes.cols())) {
    dynamics::BlockSpec spec;
    spec.q_size = spec.u_size = static_cast<int>(zero_.size());
    const int id = state_.insert(spec, rest.nodes.reshaped(), zero_);
    terms_.push_back(std::make_shared<fem::SoftBody>("body", rest, m, options, id));
    if (options.volumetric_share < 1.0)
      terms_.push_back(std::make_shared<fem::NodalDilatation>("body", rest, m, options, id));
    dynamics::PatternBuilder builder(state_.layout());
    for (const auto& term : terms_) term->add_pattern(builder);
    A_.body = builder.build();
    mass_ = fem::lumped_masses(rest, m.density).replicate(1, 3).transpose().reshaped();
  }
  const TetMesh& rest() const { return rest_; }
  const VecX& zero() const { return zero_; }
  const VecX& mass() const { return mass_; }
  VecX force(const VecX& x, const VecX& v) {
    VecX f = zero_;
    for (const auto& term : terms_) term->add_force(state_.view(0.0, x.data(), v.data()), f);
    return f;
  }
  MatX tangent(const VecX& x, const VecX& v, double k, double d) {
    A_.set_zero();
    for (const auto& term : terms_) term->add_tangent(state_.view(0.0, x.data(), v.data()), k, d, A_);
    return A_.to_dense();
  }

 private:
  TetMesh rest_;
  dynamics::State state_;
  VecX zero_, mass_;
  std::vector<std::shared_ptr<dynamics::ForceTerm>> terms_;
  dynamics::BorderedMatrix A_;
};

fem::Material rubber(double poissons_ratio, double damping) {
  fem::Material m;
  m.youngs_modulus = 1e5;
  m.poissons_ratio = poissons_ratio;
  m.stiffness_damping = damping;
  return m;
}

constexpr double kWidth = 0.2;

TetMesh beam_mesh() {
  TetMesh rest = mesh::perturbed(mesh::box(Vec3(1.0, kWidth, kWidth), {8, 2, 2}), 0.2, 72);
  rest.nodes.row(0).array() += 0.5;
  return rest;
}

/// Builds the beam held at x = 0 under an end load, P L^2/(E I) = 4.
Problem bent_beam(std::shared_ptr<Body> body) {
  const Points& X = body->rest().nodes;
  VecX load = body->zero(), free = VecX::Ones(load.size());
  std::vector<int> end;
  for (int i = 0; i < X.cols(); ++i) {
    if (X(0, i) < 1e-9) free.segment<3>(3 * i).setZero();
    if (X(0, i) > 1.0 - 1e-9) end.push_back(i);
  }
  const double total = 4.0 * 1e5 * std::pow(kWidth, 4) / 12.0;  // P L^2/(E I) = 4
  for (int i : end) load[3 * i + 1] = -total / static_cast<double>(end.size());
  Problem p;
  p.size = 0.0001;
  p.residual = [=](const VecX& x) { return VecX(-free.cwiseProduct(body->force(x, body->zero()) + load)); };
  p.matrix = [=](const VecX& x) {
    MatX K = free.asDiagonal() * body->tangent(x, body->zero(), 1.0, 0.0) * free.asDiagonal();
    K.diagonal() += VecX::Ones(free.size()) - free;
    return K;
  };
  constexpr double kArc = 1.2;  // Initial guess: a circular arc [rad].
  Points arc(3, X.cols());
  for (int i = 0; i < X.cols(); ++i) {
    const double angle = kArc * X(0, i);
    arc.col(i) = Vec3(std::sin(angle), std::cos(angle) - 1.0, 0.0) / kArc +
                 Vec3(X(1, i) * std::sin(angle), X(1, i) * std::cos(angle), X(2, i));
    if (X(0, i) < 1e-9) arc.col(i) = X.col(i);
  }
  p.solution = arc.reshaped();
  return p;
}

/// Builds one step of backward Euler for the free body, which rotates by one radian per step and is stretched
/// by a tenth. Unknown: v.
Problem spinning_step(std::shared_ptr<Body> body) {
  constexpr double kStep = 0.02;
  const Points& X = body->rest().nodes;
  const Vec3 spin = Vec3(0.3, -0.5, 0.8).normalized() / kStep, centre = X.rowwise().mean();
  const Points placed = Vec3(1.1, 0.95, 0.97).asDiagonal() * (X.colwise() - centre);
  const VecX x0 = placed.reshaped(), v0 = (cross_matrix(spin) * placed).reshaped();
  Problem p;
  p.size = 0.001 / kStep;
  p.residual = [=](const VecX& v) {
    return VecX(body->mass().cwiseProduct(v - v0) - kStep * body->force(x0 + kStep * v, v));
  };
  p.matrix = [=](const VecX& v) {
    MatX A = body->tangent(x0 + kStep * v, v, kStep * kStep, kStep);
    A.diagonal() += body->mass();
    return A;
  };
  p.solution = v0;
  return p;
}

/// Applies Newton's method with steps halved while the residual grows; returns true if it ends at rounding.
bool converge(const Problem& p, VecX& z) {
  VecX g = p.residual(z);
  double best = g.norm();
  const double first = best;
  for (int k = 0; k < 200; ++k) {
    const VecX dz = Eigen::PartialPivLU<MatX>(p.matrix(z)).solve(g);
    double t = 1.0;
    VecX trial = z - dz;
    while (p.residual(trial).norm() > best && t > 1e-3) trial = z - (t *= 0.5) * dz;
    const double now = p.residual(trial).norm();
    if (now >= best) return best < 1e-9 * first;
    z = trial;
    g = p.residual(z);
    best = now;
  }
  return false;
}

using Make = Problem (*)(std::shared_ptr<Body>);

struct Row {
  const char* name;
  Make make;
  double nu, damping;
  fem::Tangent tangent;
  bool full;
  bool nodal;
  double expected;
};

std::vector<Measurement> run(const std::string& fault) {
  using fem::Tangent;
  const Row rows[] = {
      {"bent beam, exact tangent", bent_beam, 0.4, 0.0, Tangent::kExact, false, false, 2.0},
      {"bent beam, nu = 0.49 by nodal dilatation, exact tangent", bent_beam, 0.49, 0.0, Tangent::kExact,
       false, true, 2.0},
      {"bent beam, warped tangent", bent_beam, 0.4, 0.0, Tangent::kWarped, false, false, 1.0},
      {"backward Euler, exact tangent", spinning_step, 0.4, 0.0, Tangent::kExact, false, false, 2.0},
      {"backward Euler, damped, full tangent", spinning_step, 0.4, 0.0005, Tangent::kExact, true, false, 2.0},
      {"backward Euler, damped, nodal dilatation, full tangents", spinning_step, 0.49, 0.0005,
       Tangent::kExact, true, true, 2.0},
      {"backward Euler, damped, unsymmetric part dropped", spinning_step, 0.4, 0.0005, Tangent::kExact, false,
       false, 1.0},
      {"backward Euler, warped tangent", spinning_step, 0.4, 0.0, Tangent::kWarped, false, false, 1.0},
  };
  std::vector<Measurement> out;
  for (const Row& row : rows) {
    const fem::Material m = rubber(row.nu, row.damping);
    const auto body = [&](Tangent tangent, bool full) {
      fem::SoftBodyOptions options{.tangent = tangent, .full_damping_tangent = full};
      if (row.nodal) options.volumetric_share = fem::kept_volumetric_share(m);
      return std::make_shared<Body>(beam_mesh(), m, options);
    };
    const Problem exact = row.make(body(Tangent::kExact, true));
    // With a fault, the library uses another tangent than requested.
    const Tangent given = fault == "warped-for-exact"   ? Tangent::kWarped
                          : fault == "exact-for-warped" ? Tangent::kExact
                                                        : row.tangent;
    const bool full = (row.full && fault != "unsymmetric-part-lost") || fault == "unsymmetric-part-kept";
    Problem p = row.make(body(given, full));
    VecX z = exact.solution;
    const bool solved = converge(exact, z);
    p.solution = z;
    const double found = solved ? exponent(p) : std::nan("");
    out.push_back({.quantity = std::string("exponent of the residuals: ") + row.name,
                   .computed = found,
                   .exact = row.expected,
                   .error = std::abs(found - row.expected),
                   .bar = 0.15,
                   .note = "error: absolute error of the exponent"});
  }
  return out;
}

}  // namespace

ValidationCase newton_convergence() {
  return {.name = "newton-convergence",
          .section = "C",
          .summary =
              "exponent of Newton's residuals: 2 with the exact tangent, statics and a step of backward "
              "Euler, damping too; 1 with inexact ones",
          .why = "quadratic convergence shows that force and tangent are consistent in the solver",
          .quick = true,
          .run = run,
          .faults = {{"warped-for-exact", "bent beam, exact tangent"},
                     {"warped-for-exact", "backward Euler, exact tangent"},
                     {"exact-for-warped", "warped tangent"},
                     {"unsymmetric-part-lost", "damped, full tangent"},
                     {"unsymmetric-part-kept", "unsymmetric part dropped"}}};
}

}  // namespace palpate::validation
