#include "palpate/modes/modes.h"
#include "palpate/linear/solvers.h"

#include <Spectra/SymGEigsShiftSolver.h>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/counters.h"
#include "palpate/core/error.h"

// Free vibration M x'' + K (x - x0) = 0 with x = x0 + phi cos(w t) yields K phi = l M phi, l = w^2, on the
// free directions.
//
// Shift and invert. With A = K - s M the pencil becomes  A^-1 M phi = nu phi,  nu = 1/(l - s): the modes
// nearest to the shift s have the largest nu, and Lanczos iteration finds these first (Ericsson and Ruhe
// 1980), orthogonal in the M product, in which A^-1 M is symmetric.
//   lowest    s below the spectrum: K - s M is positive definite, as its Cholesky factor proves.  K of a body
//             at rest is semi-definite, zero for rigid motions of a free body, so a small negative s is
//             sufficient; where there is no factor (the state is an unstable equilibrium) s is lowered until
//             there is one.  No mode is below s, so the modes nearest to it are the lowest.
//   highest   s above the spectrum: s M - K is positive definite.  Doubling and bisection find s within 2 %
//             above the highest l (Sylvester's law of inertia).
// The unit of l is |s| and the unit of mass is the mean mass, so that absolute thresholds of the iteration
// are meaningful.
//
// Repeated modes. A single start vector has a component along one direction of each eigenspace; its other
// directions arise only by rounding, and may be missed. So the search is repeated in the M-complement of the
// modes found, and modes found there that precede the last one are added, until there are none. The last step
// is Rayleigh-Ritz on A^-1 M X: the modes of the pencil restricted to that space, M-orthonormal to rounding.
//
// Rounding. The entries of K phi are sums that cancel: | |K||phi| | is larger than |K phi| by about
// w_max^2/w^2, and eps times | |K||phi| | is the accuracy of K phi. A shape whose |K phi| is below 1e-12 of
// it is a rigid motion, l = 0.

namespace palpate::modes {
namespace {

using namespace dynamics;

constexpr double kTolerance = 1e-8;  // Limit of the residual, relative to |K phi|.
constexpr double kRounding = 1e-14;  // Relative to | |K||phi| |: a residual below it is rounding.
constexpr double kRigid = 1e-12;     // Relative to | |K||phi| |: a force below it is zero.
constexpr double kLowShift = 1e-7;   // Relative to the mean of the spectrum, tr K / tr M.

/// K and M on the free directions.
class Pencil {
 public:
  Pencil(System& system, const StateView& state) {
    system.step_matrix(state, 0.0, 0.0, 1.0, K_);
    if (!K_.symmetric)
      fail(
          "modes: the tangent is unsymmetric (friction, or a damping that depends on position): vibration "
          "has no real modes; remove that term");
    system.step_matrix(state, 1.0, 0.0, 0.0, M_);
    for (int i = 0; i < state.layout->u_size; ++i)
      if (!system.driven_mask()[static_cast<std::size_t>(i)]) free_.push_back(i);
    if (free_.empty()) fail("modes: all directions are held or driven, so nothing is free to move");
    full_.setZero(state.layout->u_size);
  }
  Eigen::Index size() const { return static_cast<Eigen::Index>(free_.size()); }
  const std::vector<int>& free() const { return free_; }
  VecX stiffness(const VecX& x) const { return product(K_, x); }
  VecX mass(const VecX& x) const { return product(M_, x); }
  MatX stiffness_of_all(const MatX& X) const { return each(K_, X); }
  MatX mass_of_all(const MatX& X) const { return each(M_, X); }
  MatX dense(const BorderedMatrix& A) const { return MatX(A.to_dense()(free_, free_)); }
  const BorderedMatrix& K() const { return K_; }
  const BorderedMatrix& M() const { return M_; }
  double mean_mass() const { return trace(M_) / static_cast<double>(size()); }
  /// Mean of w^2, if M were a multiple of the identity.
  double mean_square() const { return trace(K_) / trace(M_); }

  /// Returns | |K||x| |.
  double summands(const VecX& x) const {
    full_.setZero();
    full_(free_) = x.cwiseAbs();
    VecX sum;
    BorderedMatrix absolute = K_;
    for (double& v : absolute.body.values()) v = std::abs(v);
    absolute.right = K_.right.cwiseAbs();
    absolute.bottom = K_.bottom.cwiseAbs();
    absolute.corner = K_.corner.cwiseAbs();
    absolute.multiply(full_, sum);
    return sum(free_).norm();
  }

  /// Computes A = sign (K - shift M) in full size; driven rows remain identity rows.
  void shifted(double shift, double sign, BorderedMatrix& A) const {
    if (A.body.pattern_version() != K_.body.pattern_version()) A = K_;
    const auto combine = [&](const auto& k, const auto& m) { return sign * (k - shift * m); };
    for (std::size_t i = 0; i < A.body.values().size(); ++i)
      A.body.values()[i] = combine(K_.body.values()[i], M_.body.values()[i]);
    A.right = sign * (K_.right - shift * M_.right);
    A.bottom = sign * (K_.bottom - shift * M_.bottom);
    A.corner = sign * (K_.corner - shift * M_.corner);
    std::vector<char> is_free(static_cast<std::size_t>(A.size()), 0);
    for (int i : free_) is_free[static_cast<std::size_t>(i)] = 1;
    for (int i = 0; i < A.nodal_size(); ++i)
      if (!is_free[static_cast<std::size_t>(i)]) A.body.block(A.body.slot(i / 3, i / 3))[4 * (i % 3)] = 1.0;
    A.touch();
  }

 private:
  double trace(const BorderedMatrix& A) const {
    double sum = 0.0;
    for (int i : free_)
      sum += i < A.nodal_size() ? A.body.block(A.body.slot(i / 3, i / 3))[4 * (i % 3)]
                                : A.corner(i - A.nodal_size(), i - A.nodal_size());
    return sum;
  }
  VecX product(const BorderedMatrix& A, const VecX& x) const {
    full_.setZero();
    full_(free_) = x;
    A.multiply(full_, result_);
    return result_(free_);
  }
  MatX each(const BorderedMatrix& A, const MatX& X) const {
    MatX Y(X.rows(), X.cols());
    for (Eigen::Index c = 0; c < X.cols(); ++c) Y.col(c) = product(A, X.col(c));
    return Y;
  }
  BorderedMatrix K_, M_;
  std::vector<int> free_;
  mutable VecX full_, result_;
};

/// Factor of sign (K - shift M), positive definite, with the shift outside the spectrum.
class ShiftedFactor {
 public:
  ShiftedFactor(const Pencil& pencil, ModesOptions::End end)
      : pencil_(pencil), solver_(linear::make_linear_solver("cholmod")), b_(VecX::Zero(pencil.K().size())) {
    const double mean = pencil.mean_square();
    if (!std::isfinite(mean)) fail("modes: the stiffness at this state is not finite");
    const double unit = mean > 0.0 ? mean : 1.0;
    end == ModesOptions::End::kLowest ? go_below(unit) : go_above(unit);
  }
  double shift() const { return shift_; }
  double sign() const { return sign_; }
  /// Returns sign (K - shift M)^-1 b on the free directions.
  VecX solve(const VecX& b) const {
    b_(pencil_.free()) = b;
    solver_->solve(b_, x_);
    return x_(pencil_.free());
  }
  const SolverCounters& counters() const { return solver_->counters(); }

 private:
  bool definite(double shift) {
    pencil_.shifted(shift_ = shift, sign_, A_);
    const SolveStatus status = solver_->factor(A_);
    if (status == SolveStatus::kSingular)
      fail("modes: the stiffness or the mass at this state is not finite");
    return status == SolveStatus::kOk;
  }
  void go_below(double mean) {
    sign_ = 1.0;
    for (double size = kLowShift * mean; !definite(-size); size *= 10.0)
      if (size > 1e6 * mean) fail("modes: the mass matrix is not positive definite");
  }
  void go_above(double mean) {
    sign_ = -1.0;
    double low = 0.0, high = mean;
    while (!definite(high)) {
      low = high;
      high *= 2.0;
      if (high > 1e12 * mean) fail("modes: the mass matrix is not positive definite");
    }
    while (high > 1.02 * low) {
      const double middle = low > 0.0 ? std::sqrt(low * high) : 0.5 * high;
      (definite(middle) ? high : low) = middle;
      if (high < 1e-12 * mean) break;  // There is no stiffness.
    }
    definite(high);
  }

  const Pencil& pencil_;
  std::unique_ptr<LinearSolver> solver_;
  BorderedMatrix A_;
  double shift_ = 0.0, sign_ = 1.0;
  mutable VecX b_, x_;
};

/// Operator of (K - shift M)^-1 for Spectra, in units of |shift| and of the mean mass, with the modes already
/// found projected out.
class Inverse {
 public:
  using Scalar = double;
  Inverse(const ShiftedFactor& factor, double scale, const MatX& found, const MatX& mass_found,
          Eigen::Index size)
      : factor_(factor), scale_(factor.sign() * scale), found_(found), mass_found_(mass_found), size_(size) {}
  Eigen::Index rows() const { return size_; }
  Eigen::Index cols() const { return size_; }
  void set_shift(const double&) {}
  void perform_op(const double* in, double* out) const {
    Eigen::Map<VecX> y(out, size_);
    y = scale_ * factor_.solve(Eigen::Map<const VecX>(in, size_));
    if (found_.cols() > 0) y -= found_ * (mass_found_.transpose() * y);
  }

 private:
  const ShiftedFactor& factor_;
  double scale_;
  const MatX &found_, &mass_found_;
  Eigen::Index size_;
};

/// Operator of M for Spectra, in units of the mean mass.
class Mass {
 public:
  using Scalar = double;
  Mass(const Pencil& pencil, double unit) : pencil_(pencil), unit_(unit) {}
  Eigen::Index rows() const { return pencil_.size(); }
  Eigen::Index cols() const { return pencil_.size(); }
  void perform_op(const double* in, double* out) const {
    Eigen::Map<VecX>(out, rows()) = pencil_.mass(Eigen::Map<const VecX>(in, rows())) / unit_;
  }

 private:
  const Pencil& pencil_;
  double unit_;
};

/// Returns entries in [-1, 1] without a pattern: fractional parts of multiples of the golden ratio.
VecX start_vector(Eigen::Index n) {
  return VecX::NullaryExpr(n, [](Eigen::Index i) {
    return 2.0 * std::fmod(0.6180339887498949 * static_cast<double>((i + 1) * (i + 3)), 1.0) - 1.0;
  });
}

/// Computes up to `wanted` modes nearest to the shift in the M-complement of `found`; the columns are
/// M-orthonormal.
MatX lanczos(const Pencil& pencil, const ShiftedFactor& factor, Eigen::Index requested, const MatX& found) {
  const Eigen::Index n = pencil.size();
  const double unit_mass = pencil.mean_mass();
  const MatX mass_found = pencil.mass_of_all(found);
  Inverse inverse(factor, std::abs(factor.shift()) * unit_mass, found, mass_found, n);
  Mass mass(pencil, unit_mass);
  const Eigen::Index room = std::min(n, std::max<Eigen::Index>(2 * requested + 10, 20));
  Spectra::SymGEigsShiftSolver<Inverse, Mass, Spectra::GEigsMode::ShiftInvert> solver(
      inverse, mass, requested, room, -factor.sign());
  VecX start = start_vector(n);
  if (found.cols() > 0) start -= found * (mass_found.transpose() * start);
  solver.init(start.data());
  const Eigen::Index got = solver.compute(Spectra::SortRule::LargestMagn, 1000, 1e-12);
  return solver.eigenvectors(got) / std::sqrt(unit_mass);
}

/// Eigenvalues l and shapes of the pencil restricted to a subspace, ordered from the shift's end of the
/// spectrum.
struct Pairs {
  VecX squared;
  MatX shapes;
};
Pairs ordered(const VecX& squared, const MatX& shapes, bool lowest, Eigen::Index requested) {
  const Eigen::Index count = std::min(requested, squared.size());  // Ascending from the dense solver.
  if (lowest) return {squared.head(count), shapes.leftCols(count)};
  return {squared.tail(count).reverse(), shapes.rightCols(count).rowwise().reverse()};
}
Pairs rayleigh_ritz(const Pencil& pencil, MatX X, bool lowest, Eigen::Index requested) {
  for (Eigen::Index c = 0; c < X.cols(); ++c) X.col(c) /= std::sqrt(X.col(c).dot(pencil.mass(X.col(c))));
  const MatX k = X.transpose() * pencil.stiffness_of_all(X), m = X.transpose() * pencil.mass_of_all(X);
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatX> small(0.5 * (k + k.transpose()),
                                                             0.5 * (m + m.transpose()));
  PALPATE_CHECK(small.info() == Eigen::Success, "modes: {} Ritz vectors are linearly dependent", X.cols());
  return ordered(small.eigenvalues(), X * small.eigenvectors(), lowest, requested);
}

Pairs all_by_dense(const Pencil& pencil, bool lowest, Eigen::Index requested) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatX> solver(pencil.dense(pencil.K()),
                                                              pencil.dense(pencil.M()));
  if (solver.info() != Eigen::Success)
    fail("modes: at this state the stiffness is not finite, or the mass is not positive definite");
  return ordered(solver.eigenvalues(), solver.eigenvectors(), lowest, requested);
}

/// Repeats the search in the complement of the modes found until no mode precedes the last one.
Pairs by_lanczos(const Pencil& pencil, const ShiftedFactor& factor, bool lowest, Eigen::Index requested) {
  Pairs pairs =
      rayleigh_ritz(pencil, lanczos(pencil, factor, requested, MatX(pencil.size(), 0)), lowest, requested);
  while (pairs.squared.size() > 0) {
    const MatX more = lanczos(pencil, factor, 1, pairs.shapes);
    if (more.cols() == 0) break;
    const VecX x = more.col(0);
    const double squared = x.dot(pencil.stiffness(x)) / x.dot(pencil.mass(x)),
                 last = pairs.squared[pairs.squared.size() - 1];
    const double before = (lowest ? last - squared : squared - last) - 1e-9 * std::abs(last - factor.shift());
    if (pairs.squared.size() == requested && before <= 0.0) break;
    MatX X(pencil.size(), pairs.shapes.cols() + 1);
    X << pairs.shapes, x;
    pairs = rayleigh_ritz(pencil, X, lowest, requested);
  }
  MatX X = pencil.mass_of_all(pairs.shapes);
  for (Eigen::Index c = 0; c < X.cols(); ++c) X.col(c) = factor.solve(X.col(c));
  return rayleigh_ritz(pencil, X, lowest, requested);
}

/// Returns the shape with driven directions: v = G u_master, the linear part of the imposed velocities.
VecX with_driven(const System& system, const StateView& state, const VecX& shape) {
  if (!system.any_driven()) return shape;
  VecX q = state.q, still = VecX::Zero(shape.size()), moving = shape;
  system.impose(*state.layout, state.time, q.data(), still.data());
  system.impose(*state.layout, state.time, q.data(), moving.data());
  return moving - still;
}

}  // namespace

double Modes::omega(int mode) const { return std::sqrt(std::max(0.0, omega_squared[mode])); }
double Modes::frequency_hz(int mode) const { return omega(mode) / (2.0 * M_PI); }

Modes find_modes(System& system, const StateView& state, const ModesOptions& options) {
  counters::count("integrate.modes");
  if (options.count < 1) fail("modes: count = {} must be at least 1", options.count);
  const Pencil pencil(system, state);
  const bool lowest = options.end == ModesOptions::End::kLowest;
  const Eigen::Index requested = std::min<Eigen::Index>(options.count, pencil.size());
  Modes out;
  Pairs pairs;
  if (2 * requested >= pencil.size()) {
    pairs = all_by_dense(pencil, lowest, requested);
  } else {
    const ShiftedFactor factor(pencil, options.end);
    pairs = by_lanczos(pencil, factor, lowest, requested);
    out.factorisations = factor.counters().factorisations;
    out.solves = factor.counters().solves;
  }
  out.converged = pairs.squared.size() == requested;
  out.omega_squared = pairs.squared;
  out.residuals.resize(pairs.squared.size());
  out.shapes.setZero(state.layout->u_size, pairs.squared.size());
  for (Eigen::Index j = 0; j < pairs.squared.size(); ++j) {
    VecX phi = pairs.shapes.col(j);
    Eigen::Index largest = 0;
    phi.cwiseAbs().maxCoeff(&largest);
    if (phi[largest] < 0.0) phi = -phi;
    const VecX force = pencil.stiffness(phi);
    const double size = force.norm(), summands = pencil.summands(phi);
    if (size <= kRigid * summands) {
      out.omega_squared[j] = 0.0;
      out.residuals[j] = summands > 0.0 ? size / summands : 0.0;
    } else {
      const double residual = (force - out.omega_squared[j] * pencil.mass(phi)).norm();
      out.residuals[j] = residual / size;
      out.converged = out.converged && residual <= std::max(kTolerance * size, kRounding * summands);
    }
    VecX shape = VecX::Zero(state.layout->u_size);
    shape(pencil.free()) = phi;
    out.shapes.col(j) = with_driven(system, state, shape);
  }
  return out;
}

}  // namespace palpate::modes
