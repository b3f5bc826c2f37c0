#include "integrate/fixed_step/displace.h"

#include <cmath>
#include <limits>

namespace palpate::integrate {
namespace {

using dynamics::Block;
using ConstMap = Eigen::Map<const VecX>;

constexpr int kMaxIterations = 200;
constexpr double kRounding = 1e-16;

bool displace_block(const Block& b, const double* q0, const double* theta, double* q1, VecX& scratch) {
  const ConstMap from(q0, b.q_size), shift(theta, b.u_size);
  Eigen::Map<VecX> to(q1, b.q_size);
  scratch.resize(3 * b.q_size);
  auto middle = scratch.head(b.q_size), rate = scratch.segment(b.q_size, b.q_size),
       next = scratch.tail(b.q_size);
  to = from;
  double change_before = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kMaxIterations; ++i) {
    middle = 0.5 * (from + to);
    b.kinematics->q_dot(middle, shift, rate);
    next = from + rate;
    const double change = (next - to).norm(), size = next.norm();
    to = next;
    if (!std::isfinite(change)) return false;
    if (change <= kRounding * size || (change <= 1e-14 * size && change >= change_before)) return true;
    change_before = change;
  }
  return false;
}

}  // namespace

bool displace(const dynamics::Layout& layout, const double* q0, const double* theta, double* q1,
              VecX& scratch) {
  for (const Block& b : layout.blocks) {
    if (b.kinematics) {
      if (!displace_block(b, q0 + b.q_offset, theta + b.u_offset, q1 + b.q_offset, scratch)) return false;
    } else {
      Eigen::Map<VecX>(q1 + b.q_offset, b.q_size) =
          ConstMap(q0 + b.q_offset, b.q_size) + ConstMap(theta + b.u_offset, b.u_size);
    }
  }
  return true;
}

}  // namespace palpate::integrate
