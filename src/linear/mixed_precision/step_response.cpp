#include "linear/step_response.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "linear/mixed_precision/energy_bound.h"
#include "linear/mixed_precision/response_columns.h"
#include "linear/mixed_precision/rigid_mode_coarse_space.h"
#include "palpate/core/error.h"

// Block conjugate gradients (O'Leary 1980) for A X = B in single precision, P^-1 the preconditioner:
//     Q = A P,  W = P^T Q,  a = W^-1 P^T R,  X += P a,  R -= Q a,
//     Z = P^-1 R,  b = -W^-1 Q^T Z,  P = Z + P b.
// Linearly dependent columns are removed from a direction by a pseudo-inverse of W. A step gains the energies
// diag(P a)^T A (P a) = diag((P^T R)^T W^-1 P^T R), and the missing part
//     e_k = |x - x_k|_A^2 = gain_k + gain_k+1 + ...
// is bounded column by column as for a single one (energy_bound.h), with gain/rho for the length of the step:
// columns help each other, so that gain/rho is larger than for a single column, and the smallest eigenvalue
// is taken to be smaller than it may be. A call that ends after a step or two yields no information on it;
// the estimate of the first call is kept.
//
// Start: X = V (V^T A V)^-1 V^T B with V the solutions of the last call, which span nearly all of the
// solutions for slowly changing right-hand sides, whatever combinations of them are requested.
//
// Tightness of the bound, relative to the missing part after five steps and more: 60 to 100 where a tool
// presses one body (scrape-pumpkin, 66 columns), 1,000 to 7,000 with additional friction on a floor
// (two-hands, 774; press-stack, 1,143). The bound uses the smallest eigenvalue, which stiff points make
// small, at full weight, however small its component in a column is.

namespace palpate::linear {

using dynamics::SolveStatus;

namespace {

/// Matrices per coarse space.
constexpr int kMatricesOfCoarse = 50;
/// Ratio of stiffness to mass of a node (SingleMatrix::stiffness) from which a coarse space pays off: below
/// it coupling hardly extends beyond a node's neighbours.
constexpr double kWorthACoarseSpace = 8.0;
/// Growth of mu per call: a call takes one or two steps, which yield little information on the smallest
/// eigenvalue, so the estimate is kept.
constexpr double kRiseOfBound = 1.0;
/// Safety factor of the bound before a call's first step: only rho is known, of a right-hand side in which no
/// eigenvalue has been seen.
constexpr double kUnseen = 10.0;
/// Safety factor of the bound after one or two steps: it was observed to be too small by up to a factor of
/// four.
constexpr double kSafety = 10.0;

}  // namespace

struct StepResponse::Impl {
  explicit Impl(int threads) : kernels(node_kernels()), team(threads), copy(kernels, team) {}

  const NodeKernels& kernels;
  ClusterTeam team;
  SingleMatrix copy;
  RigidModeCoarseSpace coarse;
  const dynamics::ZeroRowSumMatrix* room = nullptr;
  int coarse_age = 0;
  bool products_of_solutions = false;  ///< A X of the last solutions is in Q, formed while packing
  // current block of right-hand sides
  double unit = 1.0;  ///< factor from a product of two columns to the caller's units
  VecX norm;          ///< norm of each column of B; the iteration works on B/norm
  Columns B, R, P, Q, Z;
  MatX S;
  VecX rho, error_bound;
  Columns solutions;
  std::vector<EnergyBound> bounds;  ///< bound per column
  long products = 0;
  // scratch memory of the coarse space
  Singles forces, motions, of_pieces, unused;

  std::size_t length() const { return 4 * static_cast<std::size_t>(copy.nodes()); }
  void prepare();
  void multiply(const Columns& from, Columns& to);
  void precondition();
  void precondition_coarse(Singles& r, Singles& z);
  MatX in_units(const MatX& product) const { return unit * norm.asDiagonal() * product * norm.asDiagonal(); }
  VecX squares_in_units(const VecX& squares) const { return unit * norm.cwiseAbs2().cwiseProduct(squares); }
  SolveStatus start(const MatX& right);
};

StepResponse::StepResponse(int threads) : impl_(std::make_unique<Impl>(threads)) {}
StepResponse::~StepResponse() = default;

double StepResponse::point_stiffness() const { return impl_->copy.point_stiffness(); }
long StepResponse::products() const { return impl_->products; }
const MatX& StepResponse::response() const { return impl_->S; }
const VecX& StepResponse::error_bound() const { return impl_->error_bound; }
VecX StepResponse::residual_energies() const { return impl_->squares_in_units(impl_->rho); }

void StepResponse::Impl::prepare() {
  coarse.prepare(copy.order());
  coarse_age = 0;
  forces.assign(static_cast<std::size_t>(coarse.stride()), 0.0f);
  motions = forces;
  of_pieces.assign(6 * static_cast<std::size_t>(copy.order().pieces()), 0.0f);
  unused.assign(length() + kVectorTail, 0.0f);
  solutions.resize(0, length());
  products_of_solutions = false;
  bounds.clear();
}

dynamics::ZeroRowSumMatrix& StepResponse::step_matrix(const dynamics::BlockSparse& pattern) {
  Impl& m = *impl_;
  if (!m.copy.analysed(pattern)) {
    m.copy.analyse(pattern, two_level_sizes(pattern.block_rows()));
    m.prepare();
  }
  dynamics::ZeroRowSumMatrix& room = m.copy.room(pattern);
  m.room = &room;
  return room;
}

SolveStatus StepResponse::take_step_matrix() {
  Impl& m = *impl_;
  const int known = m.solutions.count() <= kMostColumns ? m.solutions.count() : 0;
  m.Q.resize(known, m.length());
  const SolveStatus status = m.copy.take_step_matrix(known, m.solutions.data(), m.Q.data());
  m.products_of_solutions = known > 0;
  if (status != SolveStatus::kOk) return status;
  m.coarse.serve(m.copy.scale());
  if (m.copy.stiffness() < kWorthACoarseSpace) {
    m.coarse.forget();
    return status;
  }
  if (!m.coarse.ready() || ++m.coarse_age > kMatricesOfCoarse) {
    m.coarse.refresh(m.copy, m.room->positions, m.kernels);
    m.coarse_age = 0;
  }
  return status;
}

/// to = A from, in the copy's units.
void StepResponse::Impl::multiply(const Columns& from, Columns& to) {
  for (int at = 0; at < from.count(); at += kMostColumns) {
    copy.multiply(std::min(kMostColumns, from.count() - at), from.data() + at, to.data() + at);
    ++products;
  }
}

/// z += Z E^-1 Z^T r + Y D^-1 Y^T r (RigidModeCoarseSpace).
void StepResponse::Impl::precondition_coarse(Singles& r, Singles& z) {
  const NodeOrder& order = copy.order();
  for (std::size_t c = 0; c < static_cast<std::size_t>(order.clusters()); ++c)
    coarse.gather(c, order, kernels, r.data(), of_pieces.data(), forces.data() + 6 * c);
  kernels.dense(coarse.inverse(), coarse.stride(), forces.data(), motions.data(), 0, coarse.size());
  for (std::size_t c = 0; c < static_cast<std::size_t>(order.clusters()); ++c)
    for (auto k = static_cast<std::size_t>(order.piece[c]); k < static_cast<std::size_t>(order.piece[c + 1]);
         ++k) {
      const RigidModeCoarseSpace::Six motion =
          coarse.motion(k, of_pieces.data() + 6 * k, motions.data() + 6 * c);
      kernels.first_direction(z.data(), coarse.arm(), motion.data(), unused.data(), z.data(),
                              order.piece_start[k], order.piece_start[k + 1]);
    }
}

/// Z = P^-1 R; rho = diag(R^T Z).
void StepResponse::Impl::precondition() {
  const int nodes = copy.nodes();
  for (int k = 0; k < R.count(); ++k) {
    kernels.jacobi(copy.inverse(), R[k].data(), Z[k].data(), 0, nodes);
    if (coarse.ready()) precondition_coarse(R[k], Z[k]);
  }
  rho = R.inner(Z).diagonal();
}

SolveStatus StepResponse::begin(const MatX& right) { return impl_->start(right); }

SolveStatus StepResponse::Impl::start(const MatX& right) {
  const auto count = static_cast<int>(right.cols());
  PALPATE_CHECK(right.rows() == 3 * copy.nodes(), "right-hand sides have {} rows, the matrix {}",
                right.rows(), 3 * copy.nodes());
  for (Columns* v : {&B, &R, &P, &Z}) v->resize(count, length());
  norm = right.colwise().norm();
  unit = copy.scale();  // (scale A)^-1 is A^-1 / scale
  const int* node = copy.order().node.data();
  for (int k = 0; k < count; ++k) {
    const double by = norm[k] > 0.0 ? 1.0 / norm[k] : 0.0;
    float* to = B[k].data();
    for (int i = 0; i < copy.nodes(); ++i, to += 4) {
      const double* from = right.data() + k * right.rows() + 3 * static_cast<std::ptrdiff_t>(node[i]);
      for (int axis = 0; axis < 3; ++axis) to[axis] = static_cast<float>(by * from[axis]);
      to[3] = 0.0f;
    }
    for (const std::size_t entry : copy.held()) B[k][entry] = 0.0f;
    std::copy(B[k].begin(), B[k].end(), R[k].begin());
  }
  Columns& X = solutions;
  if (X.count() > 0) {
    if (!std::exchange(products_of_solutions, false)) {
      Q.resize(X.count(), length());
      multiply(X, Q);
    }
    const MatX inverse_of = pseudo_inverse(X.inner(Q));
    if (inverse_of.size() == 0) return SolveStatus::kIndefinite;
    const MatX Y = inverse_of * X.inner(B);
    R.add(Q, -Y);
    Z.set_zero();
    Z.add(X, Y);
    X.swap(Z);
  } else {
    X.resize(count, length());
    X.set_zero();
  }
  Q.resize(count, length());
  Z.resize(count, length());
  const MatX BX = B.inner(X), XR = X.inner(R);
  S = in_units(0.5 * (BX + BX.transpose() + XR + XR.transpose()));
  precondition();
  if (!rho.allFinite()) return SolveStatus::kNotConverged;
  if (bounds.size() != static_cast<std::size_t>(count)) bounds.assign(static_cast<std::size_t>(count), {});
  double least = 1.0 / (1.0 + copy.point_stiffness());
  for (EnergyBound& bound : bounds) {
    bound.begin(0.0, kRiseOfBound);
    least = std::min(least, bound.mu());
  }
  error_bound.resize(count);
  for (int k = 0; k < count; ++k) {
    EnergyBound& bound = bounds[static_cast<std::size_t>(k)];
    bound.limit(least);
    error_bound[k] = bound.first() && rho[k] > 0.0 ? HUGE_VAL : kUnseen * bound.error(rho[k]);
  }
  error_bound = squares_in_units(error_bound);
  P.swap(Z);
  return SolveStatus::kOk;
}

SolveStatus StepResponse::advance() {
  Impl& m = *impl_;
  m.multiply(m.P, m.Q);
  const MatX inverse = pseudo_inverse(m.P.inner(m.Q));
  if (inverse.size() == 0) return SolveStatus::kIndefinite;
  const MatX PR = m.P.inner(m.R), a = inverse * PR, gain = PR.transpose() * a;
  if (!gain.allFinite()) return SolveStatus::kNotConverged;
  m.solutions.add(m.P, a);
  m.R.add(m.Q, -a);
  m.S += m.in_units(MatX(0.5 * (gain + gain.transpose())));
  const VecX before = m.rho;
  m.precondition();
  if (!m.rho.allFinite()) return SolveStatus::kNotConverged;
  for (Eigen::Index k = 0; k < m.rho.size(); ++k) {
    EnergyBound& bound = m.bounds[static_cast<std::size_t>(k)];
    if (before[k] > 0.0) bound.step(gain(k, k) / before[k], before[k], m.rho[k]);
    bound.end();
    m.error_bound[k] = kSafety * bound.error(m.rho[k]);
  }
  m.error_bound = m.squares_in_units(m.error_bound);
  m.Z.add(m.P, -inverse * m.Q.inner(m.Z));
  m.P.swap(m.Z);
  return SolveStatus::kOk;
}

MatX StepResponse::energies() const {
  const Impl& m = *impl_;
  const MatX XR = m.solutions.inner(m.B) - m.solutions.inner(m.R);
  return m.in_units(MatX(0.5 * (XR + XR.transpose())));
}

void StepResponse::solution(Eigen::Index k, VecX& x) const {
  const Impl& m = *impl_;
  x.resize(3 * static_cast<Eigen::Index>(m.copy.nodes()));
  const Singles& from = m.solutions[static_cast<int>(k)];
  const double by = m.unit * m.norm[k];
  for (std::size_t i = 0; i < static_cast<std::size_t>(m.copy.nodes()); ++i)
    for (std::size_t axis = 0; axis < 3; ++axis)
      x[3 * m.copy.order().node[i] + static_cast<Eigen::Index>(axis)] = by * from[4 * i + axis];
}

}  // namespace palpate::linear
