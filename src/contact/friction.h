#pragma once
#include <algorithm>
#include <span>

#include "palpate/core/types.h"

namespace palpate::contact {

/// Friction force of one sample at the end of a step, affine in the tangential velocity v at that time [N]:
///     f(v) = constant - D v
struct FrictionLine {
  Vec3 constant = Vec3::Zero();  ///< Constant part [N].
  Mat3 D = Mat3::Zero();         ///< Symmetric, positive semi-definite, zero along the normal [N s/m].
};

/// Evaluates Coulomb's law, regularised below the speed v_r: f = -L v / max(|v|, v_r) [N].
/// @param limit  L = mu times the normal force [N]  @param v  tangential velocity [m/s]
inline Vec3 friction_force(double limit, const Vec3& v, double v_r) {
  return -limit / std::max(v.norm(), v_r) * v;
}

/// Guess of a sample's sliding at the end of a step, improved from solve to solve (friction.cpp).
struct FrictionGuess {
  double limit = 0.0;     ///< L [N].
  double v_r = 0.0;       ///< Regularisation speed [m/s]; 0: no guess yet.
  Vec3 v = Vec3::Zero();  ///< Tangential velocity [m/s].
  /// Friction with which the step's equations hold at v, after at least one solve [N].
  Vec3 force = Vec3::Zero();
  /// Result of the last solve; `solved` is set for samples that pressed at its end.
  bool solved = false;
  double limit_end = 0.0;
  Vec3 v_end = Vec3::Zero(), force_end = Vec3::Zero();
};

/// Returns the first guess: the end of the step equals its start.
inline FrictionGuess first_guess(double limit, const Vec3& v, double v_r) {
  FrictionGuess out;
  out.limit = limit;
  out.v_r = v_r;
  out.v = v;
  return out;
}
/// Returns the tangent of the friction law at the guess, an affine law.
/// @param n  unit normal; v is perpendicular to it
inline FrictionLine friction_line(const FrictionGuess& guess, const Vec3& n) {
  if (guess.limit == 0.0) return {};
  const Mat3 across = Mat3::Identity() - n * n.transpose();
  const double speed = guess.v.norm();
  if (speed <= guess.v_r) return {Vec3::Zero(), guess.limit / guess.v_r * across};
  const Vec3 t = guess.v / speed;
  return {-guess.limit * t, guess.limit / speed * (across - t * t.transpose())};
}
/// Records the result of a solve.
/// @param force  friction of the affine law at the end [N]  @param limit  L at the end  @param v  velocity at
///   the end
inline void end_solve(FrictionGuess& guess, double limit, const Vec3& v, const Vec3& force) {
  guess.solved = true;
  guess.limit_end = limit;
  guess.v_end = v;
  guess.force_end = force;
}
/// Moves the guesses of a step towards the result of the last solve, as far as the sum that the solves
/// minimise decreases.
/// @param solves  number of solves in this step so far
void move_guesses(std::span<FrictionGuess> guesses, int solves);

/// Largest number of solves per step; Newton's method terminates earlier (300 chains of twelve masses with
/// random velocities took 3 to 25). The tolerance is the accepted difference between the friction of a step
/// and the law at its end, relative to the largest friction that the law allows: below a thousandth of mu N.
inline constexpr int kFrictionSolves = 40;
inline constexpr double kFrictionTolerance = 5e-4;

/// Accumulates the difference between the friction of a step and the law at the step's end.
struct FrictionError {
  double difference = 0.0, limit = 0.0;                   ///< Sums over samples of force magnitudes [N].
  Vec3 left_out = Vec3::Zero(), friction = Vec3::Zero();  ///< Sums of forces [N].
  /// Adds one sample.
  /// @param taken  force of the affine law at the end  @param limit_there  L at the end  @param v  velocity
  ///   at the end
  void add(const Vec3& taken, double limit_there, const Vec3& v, double v_r) {
    const Vec3 law = friction_force(limit_there, v, v_r);
    difference += (law - taken).norm();
    limit += limit_there;
    left_out += law - taken;
    friction += law;
  }
  /// Returns the relative difference; 0 where nothing presses.
  double relative() const { return difference > 0.0 ? (limit > 0.0 ? difference / limit : 1.0) : 0.0; }
};

}  // namespace palpate::contact
