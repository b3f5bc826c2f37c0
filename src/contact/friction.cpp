#include "contact/friction.h"

#include <cmath>

namespace palpate::contact {

// Step of one linear solve, with the friction of its end.
//
// With the normal forces held fixed, the end velocity of a linearly implicit step minimises the step's
// quadratic form plus
//     sum_i L_i phi(|v_i|),   phi(s) = s^2/(2 v_r) up to v_r,  s - v_r/2 beyond:
// the friction -L phi'(|v|) v/|v| at the end of the step lies within the cone and opposes v, whatever h. Both
// parts are convex and differentiable, so that there is one minimum, and Newton's method with a line search
// converges to it from every start. Each solve uses the tangent of friction at a guess v_k:
//
//     |v_k| <= v_r    f = -L v/v_r                                                  exact there
//     beyond          f = -L t - L/|v_k| (I - n n^T - t t^T) v,  t = v_k/|v_k|
//
// A sample that keeps sliding in its direction needs one solve, whether it speeds up or slows down within the
// step. (The secant about the start, with the end's velocity over the start's speed, resists a sample that
// speeds up by more than L and lets a block slide too late.)
//
// Where a sample stops sliding, solves overshoot in alternating directions; hence the line search. A solve
// satisfies the step's equations with the force of its affine law, and so does, with the interpolated force,
// every point between two solves, because the equations are linear. At u_k + a d, d = u_end - u_k, the
// slope of the sum is
//     s(a) = sum_i d_i . ((1 - a) f_k + a f_end - f(v_k + a d))_i,
// which involves the samples only. It increases with a, from at most 0; the next guess is its zero, at most a
// = 1. The start of a step satisfies no equation: the first solve is taken with a = 1.
//
// L follows the pressure at the end of the step from solve to solve, so that the matrix stays symmetric.
namespace {

/// Returns the contribution of a sample to s(a) [W].
double slope(const FrictionGuess& g, double a) {
  if (!g.solved) return 0.0;
  const Vec3 d = g.v_end - g.v, v = g.v + a * d;
  return d.dot((1.0 - a) * g.force + a * g.force_end - friction_force(g.limit_end, v, g.v_r));
}

/// Returns the zero of s(a), by regula falsi and bisection alternately: the sum over many samples is smooth,
/// the sum over few jumps where they stick. Returns 1 where s(1) is not positive.
/// @param s  the sum
template <class Sum>
double step_length(const Sum& s) {
  constexpr int kMost = 40;
  constexpr double kFlat = 1e-3;  // Relative to s(0): below this Newton's method converges as fast.
  double high = 1.0, s_high = s(high);
  if (s_high <= 0.0) return 1.0;
  double low = 0.0, s_low = s(low);
  if (s_low >= 0.0) return 1.0;
  const double flat = kFlat * -s_low;
  for (int i = 0; i < kMost && s_high > flat; ++i) {
    const double a = i % 2 ? (low + high) / 2.0 : (low * s_high - high * s_low) / (s_high - s_low),
                 s_a = s(a);
    if (std::abs(s_a) <= flat) return a;
    (s_a > 0.0 ? high : low) = a;
    (s_a > 0.0 ? s_high : s_low) = s_a;
  }
  return high;
}

void move(FrictionGuess& g, double a) {
  if (!g.solved) return;
  g.v += a * (g.v_end - g.v);
  g.force += a * (g.force_end - g.force);
  g.limit = g.limit_end;
  g.solved = false;
}

}  // namespace

void move_guesses(std::span<FrictionGuess> guesses, int solves) {
  const auto s = [&](double a) {
    double sum = 0.0;
    for (const FrictionGuess& g : guesses) sum += slope(g, a);
    return sum;
  };
  const double a = solves > 1 ? step_length(s) : 1.0;
  for (FrictionGuess& g : guesses) move(g, a);
}

}  // namespace palpate::contact
