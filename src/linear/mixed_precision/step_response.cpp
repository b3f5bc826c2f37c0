#include "palpate/linear/step_response.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "linear/mixed_precision/energy_bound.h"
#include "linear/mixed_precision/response_columns.h"
#include "linear/mixed_precision/rigid_mode_coarse_space.h"
#include "palpate/core/error.h"

// Block conjugate gradients (O'Leary 1980) for A X = B in single precision, P^-1 the preconditioner:
//     Q = A P,  W = P^T Q,  a = W^-1 P^T R,  X += P a,  R -= Q a,
//     Z = P^-1 R,  b = -W^-1 Q^T Z,  P = Z + P b.
// Columns that have become alike are left out of a direction by a pseudo-inverse of W.  A step gains the
// energies diag(P a)^T A (P a) = diag((P^T R)^T W^-1 P^T R), and what is missing,
//     e_k = |x - x_k|_A^2 = gain_k + gain_k+1 + ...,
// is bounded column by column as for a single one (energy_bound.h), with gain/rho for the length of the step:
// the columns help each other, gain/rho is larger than alone, and the smallest eigenvalue is taken for
// smaller than it may be. A call that ends after a step or two learns nothing of it; what the first one
// learned stays.
//
// Start: X = V (V^T A V)^-1 V^T B with V the solutions of the last call, which a right-hand side that moves
// slowly has all but the same of, whatever combination of them it asks for.

namespace palpate::linear {

using dynamics::SolveStatus;

namespace {

constexpr int kNodesOfCluster = 150, kMostClusters = 48, kNodesOfPiece = 32, kParts = 4;
/// Matrices that a coarse space serves.
constexpr int kMatricesOfCoarse = 50;
/// A call takes one step or two, which say little of the smallest eigenvalue: what is known of it lasts.
constexpr double kRiseOfBound = 1.0;
/// Before its first step a call knows rho alone, of a right-hand side that no eigenvalue was seen of.
constexpr double kUnseen = 4.0;

}  // namespace

struct StepResponse::Impl {
  explicit Impl(int threads) : kernels(node_kernels()), team(threads), copy(kernels, team) {}

  const NodeKernels& kernels;
  ClusterTeam team;
  SingleMatrix copy;
  RigidModeCoarseSpace coarse;
  const dynamics::ZeroRowSumMatrix* room = nullptr;
  int coarse_age = 0;
  // the variant
  double share = 1.0;
  Singles change_of_diagonal, inverse;  ///< m' - share m, in the copy's units; inverse blocks
  PointOperator points;                 ///< C' - share C, likewise
  // the block under way
  bool variant = false;
  double unit = 1.0;  ///< of a product of two columns, in those of the caller
  VecX norm;          ///< of each column of B: the iteration's ones are B/norm
  Columns B, R, P, Q, Z;
  MatX S;
  VecX rho, missing;
  // of the matrix and of its variant
  std::array<Columns, 2> solutions;
  std::array<std::vector<EnergyBound>, 2> bounds;  ///< of each column
  std::array<double, 2> point_stiffness{};
  long products = 0;
  // scratch of the coarse space
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

double StepResponse::point_stiffness(Which which) const {
  return impl_->point_stiffness[which == Which::kVariant];
}
long StepResponse::products() const { return impl_->products; }
const MatX& StepResponse::response() const { return impl_->S; }
const VecX& StepResponse::missing() const { return impl_->missing; }

void StepResponse::Impl::prepare() {
  coarse.prepare(copy.order());
  coarse_age = 0;
  forces.assign(static_cast<std::size_t>(coarse.stride()), 0.0f);
  motions = forces;
  of_pieces.assign(6 * static_cast<std::size_t>(copy.order().pieces()), 0.0f);
  unused.assign(length() + kVectorTail, 0.0f);
  for (Columns& X : solutions) X.resize(0, length());
  for (auto& of : bounds) of.clear();
}

dynamics::ZeroRowSumMatrix& StepResponse::step_matrix(const dynamics::BlockSparse& pattern) {
  Impl& m = *impl_;
  if (!m.copy.analysed(pattern)) {
    const int n = pattern.block_rows(),
              clusters = std::min((n + kNodesOfCluster - 1) / kNodesOfCluster, kMostClusters);
    m.copy.analyse(pattern, clusters, std::min(kParts, clusters), n / kNodesOfPiece);
    m.prepare();
  }
  dynamics::ZeroRowSumMatrix& room = m.copy.room(pattern);
  m.room = &room;
  return room;
}

SolveStatus StepResponse::take_step_matrix() {
  Impl& m = *impl_;
  const SolveStatus status = m.copy.take_step_matrix(0, nullptr, nullptr);
  if (status != SolveStatus::kOk) return status;
  m.point_stiffness[0] = m.copy.point_stiffness();
  m.coarse.serve(m.copy.scale());
  if (!m.coarse.ready() || ++m.coarse_age > kMatricesOfCoarse) {
    m.coarse.refresh(m.copy, m.room->positions, m.kernels);
    m.coarse_age = 0;
  }
  return status;
}

void StepResponse::set_variant(double share, const VecX& diagonal, const dynamics::PointStiffness& points) {
  Impl& m = *impl_;
  const std::vector<int>& place = m.copy.place_of_node();
  m.share = share;
  m.point_stiffness[1] = 0.0;
  // what the product with A has of C comes out again
  dynamics::PointStiffness all = points;
  for (auto one : m.room->points.along) {
    one.G *= -share;
    all.along.push_back(one);
  }
  for (auto one : m.room->points.points) {
    one.C *= -share;
    all.points.push_back(one);
  }
  m.points.take(all, place, m.copy.order(), m.copy.scale());
  m.change_of_diagonal.assign(m.length() + kVectorTail, 0.0f);
  m.inverse.assign(static_cast<std::size_t>(inverse_place(m.copy.nodes() + 3)) + kVectorTail, 0.0f);
  std::vector<int> diagonal_of_node(place.size(), -1);
  for (std::size_t k = 0; k < m.points.diagonal().size(); ++k)
    diagonal_of_node[static_cast<std::size_t>(m.points.diagonal()[k].node)] = static_cast<int>(k);
  std::vector<int> own_of_node(place.size(), -1);
  for (std::size_t k = 0; k < m.copy.points().diagonal().size(); ++k)
    own_of_node[static_cast<std::size_t>(m.copy.points().diagonal()[k].node)] = static_cast<int>(k);
  for (std::size_t i = 0; i < place.size(); ++i) {
    const auto at = static_cast<std::size_t>(place[i]);
    const auto own = static_cast<std::size_t>(m.copy.row_start()[at]);
    Eigen::Matrix3f block;
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Index dof = 3 * static_cast<Eigen::Index>(i) + axis;
      const auto change =
          static_cast<float>(m.copy.scale() * (diagonal[dof] - share * m.room->diagonal[dof]));
      m.change_of_diagonal[4 * at + static_cast<std::size_t>(axis)] = change;
      for (int k = 0; k < 3; ++k)
        block(k, axis) = static_cast<float>(share) * m.copy.packing().entry(own, k, axis);
      block(axis, axis) += change;
    }
    const float before = block.trace();
    if (const int k = own_of_node[at]; k >= 0)
      block += static_cast<float>(share) * m.copy.points().diagonal()[static_cast<std::size_t>(k)].block;
    if (const int k = diagonal_of_node[at]; k >= 0)
      block += m.points.diagonal()[static_cast<std::size_t>(k)].block;
    m.point_stiffness[1] = std::max(m.point_stiffness[1], static_cast<double>(block.trace() / before) - 1.0);
    const Eigen::Matrix3f inverse = block.inverse();
    float* J = m.inverse.data() + inverse_place(static_cast<int>(at));
    for (int axis = 0; axis < 3; ++axis) {
      J[axis] = inverse(axis, axis);
      J[kToOffDiagonal + axis] = inverse((axis + 1) % 3, (axis + 2) % 3);
    }
  }
  for (const std::size_t entry : m.copy.held()) {  // rows of the identity
    m.change_of_diagonal[entry] = 0.0f;
    float* J = m.inverse.data() + inverse_place(static_cast<int>(entry / 4));
    const std::size_t axis = entry % 4;
    J[axis] = 0.0f;
    for (std::size_t other = 0; other < 3; ++other)
      if (other != axis) J[kToOffDiagonal + other] = 0.0f;
  }
}

/// to = A from, in the copy's units.
void StepResponse::Impl::multiply(const Columns& from, Columns& to) {
  for (int at = 0; at < from.count(); at += kMostColumns) {
    copy.multiply(std::min(kMostColumns, from.count() - at), from.data() + at, to.data() + at);
    ++products;
  }
  if (!variant) return;
  const auto size = static_cast<Eigen::Index>(length());
  const Eigen::Map<const Eigen::ArrayXf> change(change_of_diagonal.data(), size);
  for (int k = 0; k < from.count(); ++k) {
    Eigen::Map<Eigen::ArrayXf> out(to[k].data(), size);
    out = static_cast<float>(share) * out + change * Eigen::Map<const Eigen::ArrayXf>(from[k].data(), size);
    if (!points.empty())
      for (std::size_t part = 0; part < static_cast<std::size_t>(copy.order().parts()); ++part)
        points.product(part, from[k].data(), to[k].data());
    for (const std::size_t entry : copy.held()) to[k][entry] = 0.0f;
  }
}

/// z += Z E^-1 Z^T r and the pieces' share (RigidModeCoarseSpace).
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

/// Z = P^-1 R
void StepResponse::Impl::precondition() {
  const int nodes = copy.nodes();
  for (int k = 0; k < R.count(); ++k) {
    kernels.jacobi(variant ? inverse.data() : copy.inverse(), R[k].data(), Z[k].data(), 0, nodes);
    if (!variant && coarse.ready()) precondition_coarse(R[k], Z[k]);
  }
  rho = R.inner_of_pairs(Z);
}

SolveStatus StepResponse::begin(Which which, const MatX& right) {
  Impl& m = *impl_;
  m.variant = which == Which::kVariant;
  return m.start(right);
}

SolveStatus StepResponse::Impl::start(const MatX& right) {
  const auto count = static_cast<int>(right.cols());
  PALPATE_CHECK(right.rows() == 3 * copy.nodes(), "right-hand sides have {} rows, the matrix {}",
                right.rows(), 3 * copy.nodes());
  for (Columns* v : {&B, &R, &P, &Q, &Z}) v->resize(count, length());
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
  Columns& X = solutions[variant];
  if (X.count() > 0) {
    Q.resize(X.count(), length());
    multiply(X, Q);
    const MatX inverse_of = pseudo_inverse(X.inner(Q));
    if (inverse_of.size() == 0) return SolveStatus::kIndefinite;
    const MatX Y = inverse_of * X.inner(B);
    R.combine(Q, -Y, true);
    Z.combine(X, Y, false);
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
  std::vector<EnergyBound>& of = bounds[variant];
  if (of.size() != static_cast<std::size_t>(count)) of.assign(static_cast<std::size_t>(count), {});
  double least = 1.0 / (1.0 + point_stiffness[variant]);
  for (EnergyBound& bound : of) {
    bound.begin(0.0, kRiseOfBound);
    least = std::min(least, bound.mu());
  }
  missing.resize(count);
  for (int k = 0; k < count; ++k) {
    EnergyBound& bound = of[static_cast<std::size_t>(k)];
    bound.limit(least);
    missing[k] = bound.first() && rho[k] > 0.0 ? HUGE_VAL : kUnseen * bound.error(rho[k]);
  }
  missing = squares_in_units(missing);
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
  m.solutions[m.variant].combine(m.P, a, true);
  m.R.combine(m.Q, -a, true);
  m.S += m.in_units(MatX(0.5 * (gain + gain.transpose())));
  const VecX before = m.rho;
  m.precondition();
  if (!m.rho.allFinite()) return SolveStatus::kNotConverged;
  for (Eigen::Index k = 0; k < m.rho.size(); ++k) {
    EnergyBound& bound = m.bounds[m.variant][static_cast<std::size_t>(k)];
    if (before[k] > 0.0) bound.step(gain(k, k) / before[k], before[k], m.rho[k]);
    bound.end();
    m.missing[k] = bound.error(m.rho[k]);
  }
  m.missing = m.squares_in_units(m.missing);
  m.Z.combine(m.P, -inverse * m.Q.inner(m.Z), true);
  m.P.swap(m.Z);
  return SolveStatus::kOk;
}

void StepResponse::solution(Eigen::Index k, VecX& x) const {
  const Impl& m = *impl_;
  x.resize(3 * static_cast<Eigen::Index>(m.copy.nodes()));
  const Singles& from = m.solutions[m.variant][static_cast<int>(k)];
  const double by = m.unit * m.norm[k];
  for (std::size_t i = 0; i < static_cast<std::size_t>(m.copy.nodes()); ++i)
    for (std::size_t axis = 0; axis < 3; ++axis)
      x[3 * m.copy.order().node[i] + static_cast<Eigen::Index>(axis)] = by * from[4 * i + axis];
}

}  // namespace palpate::linear
