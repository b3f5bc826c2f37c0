#include "reduced_system.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "contact_loads.h"

namespace palpate::loop {

using contact::ReducedContactModel;
using contact::ReducedSample;
using contact::ReducedTangent;

namespace {

/// Returns X^T P X for a linear map P.  @param scratch  becomes P X, as large as X
MatX products(const MatX& X, MatX& scratch, const auto& product) {
  scratch.resize(X.rows(), X.cols());
  for (Eigen::Index i = 0; i < X.cols(); ++i) scratch.col(i) = product(VecX(X.col(i)));
  return X.transpose() * scratch;
}

/// Returns the symmetric part, with negative eigenvalues replaced by zero.
MatX definite(const MatX& A) {
  const Eigen::SelfAdjointEigenSolver<MatX> eigen(MatX(0.5 * (A + A.transpose())));
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() *
         eigen.eigenvectors().transpose();
}

}  // namespace

VecX tangent_times(dynamics::System& system, const dynamics::StateView& state, double k, double d,
                   const VecX& x) {
  VecX out = VecX::Zero(x.size());
  for (const auto& term : system.terms())
    if (term->traits().has_tangent) term->apply_tangent(state, k, d, x, out);
  if (k == 0.0) return out;
  VecX carried = VecX::Zero(x.size());
  system.apply_carried_stiffness(state, x, carried);
  return out + k * carried;
}

SampleSums sum_of(const std::vector<ReducedSample>& samples, const std::vector<ReducedTangent>& tangents,
                  const MatX& X, const VecX& mean_change) {
  const Eigen::Index m = X.cols();
  SampleSums out{MatX::Zero(m, m), MatX::Zero(m, m), VecX::Zero(m), VecX::Zero(m)};
  const auto nodes_of_X = [&](int node) { return X.middleRows<3>(3 * node); };
  const auto nodes_of_change = [&](int node) { return mean_change.segment<3>(3 * node); };
  for (std::size_t j = 0; j < samples.size(); ++j) {
    const ReducedSample& s = samples[j];
    if (!presses(s)) continue;
    const Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, ReducedContactModel::kMostModes> P =
        moved_by(s, nodes_of_X);
    const auto& [K, D] = tangents[j];
    out.K.noalias() += P.transpose().lazyProduct((K * P).eval());
    out.D.noalias() += P.transpose().lazyProduct((D * P).eval());
    out.force.noalias() -= P.transpose() * s.force;
    out.stiff.noalias() += P.transpose() * (K * s.velocity + D * moved_by(s, nodes_of_change));
  }
  return out;
}

namespace {

/// Returns X^T M X.
MatX mass_in(const CoupledTool& tool, const MatX& X, MatX& scratch) {
  VecX product;
  return products(X, scratch, [&](const VecX& v) {
    tool.system.apply_mass(tool.state.view(), v, product);
    return product;
  });
}

}  // namespace

ReducedSystem reduce_exactly(const CoupledTool& tool, const MatX& X, const SampleSums& samples,
                             MatX& scratch) {
  const auto tangent = [&](double k, double d) {
    return products(X, scratch,
                    [&](const VecX& v) { return tangent_times(tool.system, tool.state.view(), k, d, v); });
  };
  ReducedSystem out;
  out.M = mass_in(tool, X, scratch);
  out.K = tangent(1.0, 0.0) - samples.K;
  out.D = tangent(0.0, 1.0) - samples.D;
  return out;
}

ReducedSystem reduce_by_work(const CoupledTool& tool, double H, const MatX& X, const MatX& work,
                             const SampleSums& samples, bool others, double a, double b, MatX& scratch) {
  ReducedSystem out;
  out.M = mass_in(tool, X, scratch);
  // Contact of bodies with obstacles, each other and other tools.
  MatX others_K = MatX::Zero(X.cols(), X.cols()), others_D = others_K;
  if (others) {
    VecX product;
    const auto contact = [&](double k, double d) {
      return products(X, scratch, [&](const VecX& v) {
        product.setZero(v.size());
        tool.contact.apply_tangent(tool.state.view(), k, d, v, product);
        return product;
      });
    };
    others_K = contact(1.0, 0.0) - samples.K;
    others_D = contact(0.0, 1.0) - samples.D;
  }
  const MatX elements =
      (work - (1.0 + H * a) * out.M - H * H * (samples.K + others_K) - H * (samples.D + others_D)) /
      (H * H + H * b);
  out.K = elements + others_K;
  out.D = a * out.M + b * elements + others_D;
  return out;
}

MatX modes_of(const ReducedSystem& system, double dependence, ReducedContactModel& out) {
  constexpr int kMost = ReducedContactModel::kMostModes;
  const auto& [M, K, D] = system;
  VecX scale = M.diagonal();
  for (double& one : scale) one = one > 0.0 ? 1.0 / std::sqrt(one) : 0.0;
  const Eigen::SelfAdjointEigenSolver<MatX> mass(
      MatX(scale.asDiagonal() * (0.5 * (M + M.transpose())) * scale.asDiagonal()));
  const VecX& lengths = mass.eigenvalues();  // ascending
  const Eigen::Index all = lengths.size(),
                     alone = (lengths.array() > dependence * std::max(lengths[all - 1], 0.0)).count(),
                     kept = std::min<Eigen::Index>(kMost, alone);
  out.modes = static_cast<int>(kept);
  if (kept == 0) return MatX(all, 0);  // every node that responds is held
  MatX S = scale.asDiagonal() * mass.eigenvectors().rightCols(kept) *
           lengths.tail(kept).cwiseSqrt().cwiseInverse().asDiagonal();
  const MatX k = S.transpose() * K * S;
  const Eigen::SelfAdjointEigenSolver<MatX> stiffness(MatX(0.5 * (k + k.transpose())));
  S = (S * stiffness.eigenvectors()).eval();
  Eigen::Map<VecX>(out.stiffness.data(), kept) = stiffness.eigenvalues().cwiseMax(0.0);
  Eigen::Map<MatX>(out.damping.data(), kMost, kMost).topLeftCorner(kept, kept) =
      definite(S.transpose() * D * S);
  return S;
}

}  // namespace palpate::loop
