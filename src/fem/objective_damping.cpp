#include "objective_damping.h"

namespace palpate::fem {

Mat3 strain_rate(const Mat3& F, const Mat3& F_dot) {
  const Mat3 M = F.transpose() * F_dot;
  return 0.5 * (M + M.transpose());
}

Mat3 damping_stress(const Mat3& rate, const Lame& damping) {
  Mat3 sigma = 2.0 * damping.mu * rate;
  sigma.diagonal().array() += damping.lambda * rate.trace();
  return sigma;
}

void add_damping_blocks(const Mat3& gradients, const Mat3& F, const Lame& damping, double scale,
                        ElementBlocks& D) {
  const Mat3 k = F * gradients.transpose();  // columns k_a
  const Mat3 gram = gradients * gradients.transpose();
  const Mat3 B2 = F * F.transpose();
  for (int a = 0; a < 3; ++a)
    for (int b = a; b < 3; ++b) {
      const Mat3 outer = k.col(a) * k.col(b).transpose();
      const Mat3 block = damping.mu * (gram(a, b) * B2 + outer.transpose()) + damping.lambda * outer;
      D[static_cast<std::size_t>(3 * a + b)] += scale * block;
      if (b > a) D[static_cast<std::size_t>(3 * b + a)] += scale * block.transpose();
    }
}

void add_damping_position_blocks(const Mat3& gradients, const Mat3& F, const Mat3& F_dot, const Lame& damping,
                                 double scale, ElementBlocks& K) {
  const Mat3 k = F * gradients.transpose(), l = F_dot * gradients.transpose();
  const Mat3 gram = gradients * gradients.transpose();
  // g_a . Sigma g_b
  const Mat3 geometric = gradients * damping_stress(strain_rate(F, F_dot), damping) * gradients.transpose();
  const Mat3 FFdot = F * F_dot.transpose();
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      Mat3 block = damping.mu * (gram(a, b) * FFdot + k.col(b) * l.col(a).transpose()) +
                   damping.lambda * k.col(a) * l.col(b).transpose();
      block.diagonal().array() += geometric(a, b);
      K[static_cast<std::size_t>(3 * a + b)] += scale * block;
    }
}

}  // namespace palpate::fem
