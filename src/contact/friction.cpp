#include "contact/friction.h"

#include <algorithm>

namespace palpate::contact {

// A step of one linear solve, whose friction is that of its end.
//
// With the normal forces held, the end velocity of a linearly implicit step is the minimum of the step's own
// quadratic form plus
//     sum_i L_i phi(|v_i|),   phi(s) = s^2/(2 v_r) up to v_r,  s - v_r/2 beyond:
// friction -L phi'(|v|) v/|v| lies within the cone and against v at the end of the step, whatever h.  Both
// parts are convex and have gradients, so that there is one minimum and Newton's method with a line search
// finds it from everywhere.  Each solve takes friction as its tangent about a guess v_k:
//
//     |v_k| <= v_r    f = -L v/v_r                                                  exact there
//     beyond          f = -L t - L/|v_k| (I - n n^T - t t^T) v,  t = v_k/|v_k|
//
// A sample that keeps sliding in its direction needs one solve, whether it speeds up or slows down within
// the step.  (The secant about the start, with the end's velocity over the start's speed, resists what speeds
// up by more than L and lets a block slide too late.)
//
// Where a sample stops sliding a solve carries it beyond, and from there back.  Hence the line search.  A
// solve satisfies the step's equations with the force of its line, and so does, with the interpolated force,
// every point between two of them: they are linear.  At u_k + a d, d = u_end - u_k, the sum's slope is
//     s(a) = sum_i d_i . ((1 - a) f_k + a f_end - f(v_k + a d))_i,
// of the samples alone.  It increases with a, from at most 0; the next guess is its zero, at most a = 1.  The
// start of a step satisfies no equation: the first solve is taken whole.
//
// L follows the pressure that the step itself ends with, from solve to solve: so the matrix stays symmetric.
namespace {

/// s(a)
double slope(std::span<const FrictionGuess> guesses, double a) {
  double out = 0.0;
  for (const FrictionGuess& g : guesses) {
    if (!g.solved) continue;
    const Vec3 d = g.v_end - g.v;
    out += d.dot((1.0 - a) * g.force + a * g.force_end - friction_force(g.limit_end, g.v + a * d, g.v_r));
  }
  return out;
}

/// Where s(a) = 0, by bisection; 1 where it is not positive there.
double step_length(std::span<const FrictionGuess> guesses) {
  constexpr int kHalvings = 20;
  if (slope(guesses, 1.0) <= 0.0 || slope(guesses, 0.0) >= 0.0) return 1.0;
  double low = 0.0, high = 1.0;
  for (int i = 0; i < kHalvings; ++i) {
    const double a = (low + high) / 2.0;
    (slope(guesses, a) > 0.0 ? high : low) = a;
  }
  return high;
}

}  // namespace

Vec3 friction_force(double limit, const Vec3& v, double v_r) { return -limit / std::max(v.norm(), v_r) * v; }

FrictionGuess first_guess(double limit, const Vec3& v, double v_r) {
  FrictionGuess out;
  out.limit = limit;
  out.v_r = v_r;
  out.v = v;
  return out;
}

FrictionLine friction_line(const FrictionGuess& guess, const Vec3& n) {
  if (guess.limit == 0.0) return {};
  const double speed = guess.v.norm();
  const Mat3 P = Mat3::Identity() - n * n.transpose();
  if (speed <= guess.v_r) return {Vec3::Zero(), guess.limit / guess.v_r * P};
  const Vec3 t = guess.v / speed;
  return {-guess.limit * t, guess.limit / speed * (P - t * t.transpose())};
}

void end_solve(FrictionGuess& guess, double limit, const Vec3& v, const Vec3& force) {
  guess.solved = true;
  guess.limit_end = limit;
  guess.v_end = v;
  guess.force_end = force;
}

void move_guesses(std::span<FrictionGuess> guesses, int solves) {
  const double a = solves > 1 ? step_length(guesses) : 1.0;
  for (FrictionGuess& g : guesses) {
    if (!g.solved) continue;
    g.v += a * (g.v_end - g.v);
    g.force += a * (g.force_end - g.force);
    g.limit = g.limit_end;
    g.solved = false;
  }
}

}  // namespace palpate::contact
