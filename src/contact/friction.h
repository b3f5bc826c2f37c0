#pragma once
#include <algorithm>
#include <span>

#include "palpate/core/types.h"

namespace palpate::contact {

/// Friction force of one sample at the end of a step, affine in the tangential velocity v there [N]:
///     f(v) = constant - D v
struct FrictionLine {
  Vec3 constant = Vec3::Zero();  ///< [N]
  Mat3 D = Mat3::Zero();         ///< symmetric, positive semi-definite, zero along the normal [N s/m]
};

/// Coulomb's law, regularised below the speed v_r:  f = -L v / max(|v|, v_r) [N].
/// @param limit  L = mu times the normal force [N]  @param v  tangential velocity [m/s]
inline Vec3 friction_force(double limit, const Vec3& v, double v_r) {
  return -limit / std::max(v.norm(), v_r) * v;
}

/// Guess of how a sample slides at the end of a step, improved from solve to solve (friction.cpp).
struct FrictionGuess {
  double limit = 0.0;         ///< L [N]
  double v_r = 0.0;           ///< 0: there is no guess yet [m/s]
  Vec3 v = Vec3::Zero();      ///< tangential velocity [m/s]
  Vec3 force = Vec3::Zero();  ///< with which the step's equations hold at v, once a solve was made [N]
  /// What the last solve ended with; `solved` of the samples that pressed there.
  bool solved = false;
  double limit_end = 0.0;
  Vec3 v_end = Vec3::Zero(), force_end = Vec3::Zero();
};

/// The first guess: the step ends as it begins.
inline FrictionGuess first_guess(double limit, const Vec3& v, double v_r) {
  FrictionGuess out;
  out.limit = limit;
  out.v_r = v_r;
  out.v = v;
  return out;
}
/// The law made affine about the guess: its tangent.
/// @param n  unit normal, across which v lies
inline FrictionLine friction_line(const FrictionGuess& guess, const Vec3& n) {
  if (guess.limit == 0.0) return {};
  const Mat3 across = Mat3::Identity() - n * n.transpose();
  const double speed = guess.v.norm();
  if (speed <= guess.v_r) return {Vec3::Zero(), guess.limit / guess.v_r * across};
  const Vec3 t = guess.v / speed;
  return {-guess.limit * t, guess.limit / speed * (across - t * t.transpose())};
}
/// Writes down what a solve ended with.
/// @param force  of the line there [N]  @param limit  L there  @param v  there
inline void end_solve(FrictionGuess& guess, double limit, const Vec3& v, const Vec3& force) {
  guess.solved = true;
  guess.limit_end = limit;
  guess.v_end = v;
  guess.force_end = force;
}
/// Moves the guesses of a step towards what the last solve ended with, as far as that makes its sum smaller.
/// @param solves  done so far in this step
void move_guesses(std::span<FrictionGuess> guesses, int solves);

/// Solves of a step, at most: Newton's method ends by itself (300 chains of twelve masses, all thrown at
/// random, took 3 to 25).  And the difference between the friction that a step took and the law's at its end
/// that it may leave, of the largest that the law allows: below a thousandth of mu N.
inline constexpr int kFrictionSolves = 40;
inline constexpr double kFrictionTolerance = 5e-4;

/// Sums the difference between the friction of a step and the law's at the step's end.
struct FrictionError {
  double difference = 0.0, limit = 0.0;                   ///< over samples, sizes of forces [N]
  Vec3 left_out = Vec3::Zero(), friction = Vec3::Zero();  ///< sums of forces [N]
  /// @param taken  force of the line at the end  @param limit  L there  @param v  there
  void add(const Vec3& taken, double limit_there, const Vec3& v, double v_r) {
    const Vec3 law = friction_force(limit_there, v, v_r);
    difference += (law - taken).norm();
    limit += limit_there;
    left_out += law - taken;
    friction += law;
  }
  /// Relative; 0 where nothing presses.
  double relative() const { return difference > 0.0 ? (limit > 0.0 ? difference / limit : 1.0) : 0.0; }
};

}  // namespace palpate::contact
