#include "integrate/error_weights.h"

#include <cmath>

namespace palpate::integrate {
namespace {

using dynamics::Block;
using dynamics::BlockKind;

/// Not zero: CVODE inverts the weights when it looks for a first step.
constexpr double kNoWeight = 1e-30;

void fill_u(const IntegratorSpec& spec, const double* u, double* w, int count, double scale) {
  if (count == 0) return;
  const double rms = Eigen::Map<const VecX>(u, count).norm() / std::sqrt(static_cast<double>(count));
  Eigen::Map<VecX>(w, count).setConstant(1.0 / (spec.rtol * (spec.atol_u * scale + rms)));
}

void fill_block(const IntegratorSpec& spec, const Block& b, const double* u, double* wq, double* wu) {
  const double q_weight = 1.0 / (spec.rtol * spec.atol_q);
  Eigen::Map<VecX>(wq, b.q_size).setConstant(q_weight / b.q_scale);
  if (b.kind != BlockKind::kRigidBody || b.q_size != 7 || b.u_size != 6)
    return fill_u(spec, u, wu, b.u_size, b.u_scale);
  Eigen::Map<VecX>(wq, 4).setConstant(q_weight);
  fill_u(spec, u, wu, 3, b.u_scale / b.q_scale);
  fill_u(spec, u + 3, wu + 3, 3, b.u_scale);
}

}  // namespace

void error_weights(const dynamics::Layout& layout, const IntegratorSpec& spec,
                   const std::vector<char>& driven, const double* u, double* w) {
  for (const Block& b : layout.blocks)
    fill_block(spec, b, u + b.u_offset, w + b.q_offset, w + layout.q_size + b.u_offset);
  int active = layout.q_size + layout.u_size;
  for (int dof = 0; dof < layout.nodal_size; ++dof)
    if (driven[static_cast<std::size_t>(dof)]) {
      w[dof] = w[layout.q_size + dof] = kNoWeight;
      active -= 2;
    }
  if (active > 0)
    Eigen::Map<VecX>(w, layout.q_size + layout.u_size) *=
        std::sqrt(static_cast<double>(layout.q_size + layout.u_size) / active);
}

}  // namespace palpate::integrate
