#include "device/arm_axis.h"

#include <algorithm>
#include <cmath>

namespace palpate::device {

// With p = p0 + q s over a step, y = (x, v, p, q) satisfies y' = A y, so y(s) = exp(A s) y(0) for all k, d
// and q (including a free mass, k = d = 0). exp by scaling and squaring: A s / 2^n has a norm below 1/2, so
// that sixteen terms of the series have an error of 2^-17/17! < 1e-19. The third and fourth columns are
// divided by M last: the norm is independent of 1/M.
Eigen::Matrix<double, 2, 4> arm_transition(const ArmAxis::Parameters& a, double s) {
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  A(0, 1) = 1.0;
  A.row(1) << -a.stiffness / a.mass, -a.damping / a.mass, 1.0, 0.0;
  A(2, 3) = 1.0;
  A *= s;
  int squarings = 0;
  for (double norm = A.cwiseAbs().rowwise().sum().maxCoeff(); norm > 0.5; norm *= 0.5) ++squarings;
  A *= std::ldexp(1.0, -squarings);
  Eigen::Matrix4d out = Eigen::Matrix4d::Identity();
  for (int term = 16; term > 0; --term) out = (Eigen::Matrix4d::Identity() + A * out / term).eval();
  for (int i = 0; i < squarings; ++i) out = (out * out).eval();
  Eigen::Matrix<double, 2, 4> rows = out.topRows<2>();
  rows.rightCols<2>() /= a.mass;
  return rows;
}

void ArmAxis::archive(Archive& a) {
  a("x", x_);
  a("v", v_);
  a("usual_step", kept_length_);
  if (a.is_restoring() && kept_length_ > 0.0) kept_ = arm_transition(a_, kept_length_);
}

ArmAxis::Point ArmAxis::at(double s, double p, double q) const {
  const Eigen::Vector2d y = arm_transition(a_, s) * Eigen::Vector4d(x_, v_, p, q);
  return {y[0], y[1], (p + q * s - a_.stiffness * y[0] - a_.damping * y[1]) / a_.mass};
}

void ArmAxis::advance(double h, double p0, double p1) {
  const double q = (p1 - p0) / h;
  if (a_.friction > 0.0) return advance_with_friction(h, p0, q);
  // Ticks differ by the rounding of their clock.
  if (std::abs(h - kept_length_) > 1e-9 * h) kept_ = arm_transition(a_, h), kept_length_ = h;
  const Eigen::Vector2d y = kept_ * Eigen::Vector4d(x_, v_, p0, q);
  x_ = y[0], v_ = y[1];
}

// Coulomb friction makes the system piecewise linear. During sliding with sign(v) = S a constant force -S f
// acts until v reaches 0. The time of that zero is computed, so friction never acts along v and never adds
// energy. At rest the pull is N = p - k x; while |N| <= f, friction balances it and v is exactly 0. N is
// linear in time there, so the time at which |N| = f is known; from then on the mass slides towards N.
//
// A piece has a length of at most 1/sqrt(k/M), less than a quarter of a period: v and v' then change sign at
// most once or twice, and the sign of v' at both ends detects a dip of v in between.
void ArmAxis::advance_with_friction(double h, double p, double q) {
  const double rate = std::sqrt(a_.stiffness / a_.mass);
  const int pieces = std::max(1, static_cast<int>(std::ceil(h * rate)));
  constexpr int kMostEvents = 32;  // Per piece; beyond, the mass sticks for the rest of the piece.
  for (int i = 0; i < pieces; ++i) {
    double left = h / pieces, now = p + q * h * i / pieces;
    for (int event = 0; left > 0.0; ++event) {
      double sign = v_ > 0.0 ? 1.0 : -1.0;
      const bool from_rest = v_ == 0.0;
      if (from_rest && (event >= kMostEvents || stays_to(left, now, q, sign))) break;
      const double slid = slide(left, now - sign * a_.friction, q, sign, from_rest);
      left -= slid;
      now += q * slid;
    }
  }
}

/// Returns whether a mass at rest remains at rest for all of `left`. Otherwise advances `left` and `p` to the
/// time at which sliding begins, in direction `sign`.
bool ArmAxis::stays_to(double& left, double& p, double q, double& sign) const {
  const double pull = p - a_.stiffness * x_;
  if (std::abs(pull) > a_.friction) {
    sign = pull > 0.0 ? 1.0 : -1.0;
    return false;
  }
  if (q == 0.0) return true;
  sign = q > 0.0 ? 1.0 : -1.0;
  const double wait = (sign * a_.friction - pull) / q;
  if (!(wait < left)) return true;
  left -= wait;
  p += q * wait;
  return false;
}

/// Slides for `left` or until v = 0, and returns the duration.
double ArmAxis::slide(double left, double p, double q, double sign, bool from_rest) {
  const Point start = at(0.0, p, q), end = at(left, p, q);
  double low = 0.0, high = 0.0;  // v changes sign between them
  if (sign * end.v < 0.0) {
    high = left;
    if (from_rest && sign * start.a > 0.0) low = zero_of(&Point::a, 0.0, left, p, q);  // the maximum of v
  } else if (!from_rest && sign * start.a < 0.0 && sign * end.a > 0.0) {
    const double dip = zero_of(&Point::a, 0.0, left, p, q);
    if (sign * at(dip, p, q).v < 0.0) high = dip;
  }
  const double slid = high > 0.0 ? zero_of(&Point::v, low, high, p, q) : left;
  x_ = high > 0.0 ? at(slid, p, q).x : end.x;
  v_ = high > 0.0 ? 0.0 : end.v;
  return slid;
}

/// Bisection to full precision: it cannot fail, and these events are rare.
double ArmAxis::zero_of(double Point::*what, double low, double high, double p, double q) const {
  const bool rising = at(high, p, q).*what > 0.0;
  for (int i = 0; i < 54; ++i) {
    const double middle = 0.5 * (low + high);
    ((at(middle, p, q).*what > 0.0) == rising ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace palpate::device
