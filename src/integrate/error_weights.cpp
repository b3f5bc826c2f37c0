#include "integrate/error_weights.h"

#include <cmath>

namespace palpate::integrate {
namespace {

using dynamics::Block;

/// Not zero: CVODE divides by the weights when it selects its first step.
constexpr double kNoWeight = 1e-30;

bool marked(const std::vector<char>& mask, int i) {
  return !mask.empty() && mask[static_cast<std::size_t>(i)] != 0;
}

/// Sets the weights of the angular velocities of a block, or of its other velocities.
void fill_u(const IntegratorSpec& spec, const Block& b, bool angular, const double* u, double* w) {
  const auto weight = [&](double norm, int count, double scale) {
    return 1.0 / (spec.rtol * (spec.atol_u * scale + norm / std::sqrt(static_cast<double>(count))));
  };
  if (b.angles_u.empty()) {  // Nodes: many entries.
    if (!angular && b.u_size > 0)
      Eigen::Map<VecX>(w, b.u_size)
          .setConstant(weight(Eigen::Map<const VecX>(u, b.u_size).norm(), b.u_size, b.u_scale));
    return;
  }
  double sum = 0.0;
  int count = 0;
  for (int i = 0; i < b.u_size; ++i)
    if (marked(b.angles_u, i) == angular) {
      sum += u[i] * u[i];
      ++count;
    }
  if (count == 0) return;
  const double one = weight(std::sqrt(sum), count, angular ? b.u_scale / b.q_scale : b.u_scale);
  for (int i = 0; i < b.u_size; ++i)
    if (marked(b.angles_u, i) == angular) w[i] = one;
}

void fill_block(const IntegratorSpec& spec, const Block& b, const double* u, double* wq, double* wu) {
  const double q_weight = 1.0 / (spec.rtol * spec.atol_q);
  for (int i = 0; i < b.q_size; ++i) wq[i] = marked(b.angles_q, i) ? q_weight : q_weight / b.q_scale;
  fill_u(spec, b, false, u, wu);
  fill_u(spec, b, true, u, wu);
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
