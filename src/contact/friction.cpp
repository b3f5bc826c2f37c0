#include "contact/friction.h"

#include <algorithm>

namespace palpate::contact {

// A step of one linear solve, whose friction is that of its end.
//
// With the normal forces held, the end velocity of a linearly implicit step is the minimum of the step's own
// quadratic form plus
//     sum_i L_i phi(|v_i|),   phi(s) = s^2/(2 v_r) up to v_r,  s - v_r/2 beyond:
// friction -L phi'(|v|) v/|v| lies within the cone and against v at the end of the step, whatever h.  Both
// parts are convex, so that there is one minimum.  Each solve takes friction as affine about a guess v_k:
//
//     sticks   |v_k| <= v_r    f = -L v/v_r                                       exact there
//     slides   beyond          f = -L t - L/|v_k| (I - n n^T - t t^T) v,  t = v_k/|v_k|     the tangent
//     secant                   f = -L v/max(|v_k|, v_r)
//
// The tangent is Newton's method: a sample that goes on sliding the way it slid needs one solve, and whether
// it speeds up or slows down within the step makes no difference.  (The secant about the start, which has
// the end's velocity over the start's speed, resists what speeds up by more than L and lets a block slide
// too late.)  But where the sliding ends in the step the tangent carries it beyond, v . t < 0, and from there
// back, without end: c = h L/m, m u + c sign(u) = b with |b| < c.  Such a sample sticks in the next solve.
// In one dimension that ends after three solves: slides; sticks, where |b| <= c + m v_r; else slides the
// other way.
//
// With many samples nothing bounds the number of such changes.  The secant's quadratic form L |v|^2/(2 |v_k|)
// + constant touches L phi at v_k and lies above it elsewhere (of concave phi(sqrt(s)) the tangent by s), so
// that each solve with it makes the sum smaller (iteratively reweighted least squares, Weiszfeld 1937): it
// takes over after kNewtonSolves, and converges slowly but always.
//
// L follows the pressure that the step itself ends with, from solve to solve: so the matrix stays symmetric.
namespace {

constexpr int kNewtonSolves = 5;

}  // namespace

Vec3 friction_force(double limit, const Vec3& v, double v_r) { return -limit / std::max(v.norm(), v_r) * v; }

FrictionGuess first_guess(double limit, const Vec3& v, double v_r) {
  using Kind = FrictionGuess::Kind;
  return {v.norm() <= v_r ? Kind::kSticks : Kind::kSlides, limit, v};
}

FrictionGuess next_guess(const FrictionGuess& last, double limit, const Vec3& v, double v_r, int solves) {
  using Kind = FrictionGuess::Kind;
  FrictionGuess next = first_guess(limit, v, v_r);
  if (next.kind == Kind::kSlides && solves >= kNewtonSolves) next.kind = Kind::kSecant;
  if (next.kind == Kind::kSlides && last.kind == Kind::kSlides && v.dot(last.v) <= 0.0)
    next.kind = Kind::kSticks;
  return next;
}

FrictionLine friction_line(const FrictionGuess& guess, const Vec3& n, double v_r) {
  using Kind = FrictionGuess::Kind;
  const double speed = guess.v.norm();
  const Mat3 P = Mat3::Identity() - n * n.transpose();
  switch (guess.kind) {
    case Kind::kSticks: return {Vec3::Zero(), guess.limit / v_r * P};
    case Kind::kSecant: return {Vec3::Zero(), guess.limit / std::max(speed, v_r) * P};
    case Kind::kSlides: break;
  }
  const Vec3 t = guess.v / speed;
  return {-guess.limit * t, guess.limit / speed * (P - t * t.transpose())};
}

}  // namespace palpate::contact
