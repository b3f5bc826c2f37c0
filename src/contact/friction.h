#pragma once
#include <algorithm>
#include <span>
#include <type_traits>

#include "palpate/core/types.h"

namespace palpate::contact {

using Vec2 = Eigen::Vector2d;
using Mat2 = Eigen::Matrix2d;

/// Friction force of one sample at the end of a step, affine in the tangential velocity v there [N]:
///     f(v) = constant - D v
/// @tparam Vec  Vec3, or Vec2 along two directions that are orthogonal to the normal and to each other
template <class Vec>
struct FrictionLineOf {
  using Mat = Eigen::Matrix<double, Vec::RowsAtCompileTime, Vec::RowsAtCompileTime>;
  Vec constant = Vec::Zero();  ///< [N]
  Mat D = Mat::Zero();         ///< symmetric, positive semi-definite, zero along the normal [N s/m]
};
using FrictionLine = FrictionLineOf<Vec3>;

/// Coulomb's law, regularised below the speed v_r:  f = -L v / max(|v|, v_r) [N].
/// @param limit  L = mu times the normal force [N]  @param v  tangential velocity [m/s]
template <class Vec>
Vec friction_force(double limit, const Vec& v, double v_r) {
  return -limit / std::max(v.norm(), v_r) * v;
}

/// Guess of how a sample slides at the end of a step, improved from solve to solve (friction.cpp).
template <class Vec>
struct FrictionGuessOf {
  double limit = 0.0;       ///< L [N]
  double v_r = 0.0;         ///< 0: there is no guess yet [m/s]
  Vec v = Vec::Zero();      ///< tangential velocity [m/s]
  Vec force = Vec::Zero();  ///< with which the step's equations hold at v, once a solve was made [N]
  /// What the last solve ended with; `solved` of the samples that pressed there.
  bool solved = false;
  double limit_end = 0.0;
  Vec v_end = Vec::Zero(), force_end = Vec::Zero();
};
using FrictionGuess = FrictionGuessOf<Vec3>;
using FrictionGuess2 = FrictionGuessOf<Vec2>;

/// The first guess: the step ends as it begins.
inline FrictionGuess first_guess(double limit, const Vec3& v, double v_r) {
  FrictionGuess out;
  out.limit = limit;
  out.v_r = v_r;
  out.v = v;
  return out;
}
/// The law made affine about the guess: its tangent.
/// @param across  the projection to the plane across the normal
template <class Vec>
[[gnu::always_inline]] inline FrictionLineOf<Vec> friction_line(
    const FrictionGuessOf<Vec>& guess, const typename FrictionLineOf<Vec>::Mat& across) {
  if (guess.limit == 0.0) return {};
  const double speed = guess.v.norm();
  if (speed <= guess.v_r) return {Vec::Zero(), guess.limit / guess.v_r * across};
  const Vec t = guess.v / speed;
  return {-guess.limit * t, guess.limit / speed * (across - t * t.transpose())};
}
/// @param n  unit normal, across which v lies
inline FrictionLine friction_line(const FrictionGuess& guess, const Vec3& n) {
  return friction_line(guess, Mat3(Mat3::Identity() - n * n.transpose()));
}
inline FrictionLineOf<Vec2> friction_line(const FrictionGuess2& guess) {
  return friction_line(guess, Mat2::Identity());
}
/// Writes down what a solve ended with.
/// @param force  of the line there [N]  @param limit  L there  @param v  there
template <class Vec>
void end_solve(FrictionGuessOf<Vec>& guess, double limit, const std::type_identity_t<Vec>& v,
               const std::type_identity_t<Vec>& force) {
  guess.solved = true;
  guess.limit_end = limit;
  guess.v_end = v;
  guess.force_end = force;
}
/// Moves the guesses of a step towards what the last solve ended with, as far as that makes its sum smaller.
/// @param solves  done so far in this step
void move_guesses(std::span<FrictionGuess> guesses, std::span<FrictionGuess2> in_planes, int solves);
inline void move_guesses(std::span<FrictionGuess> guesses, int solves) { move_guesses(guesses, {}, solves); }

/// Solves of a step, at most: Newton's method ends by itself (300 chains of twelve masses, all thrown at
/// random, took 3 to 25).  And the difference between the friction that a step took and the law's at its end
/// that it may leave, of the largest that the law allows: below a thousandth of mu N.
inline constexpr int kFrictionSolves = 40;
inline constexpr double kFrictionTolerance = 5e-4;

/// Sums the difference between the friction of a step and the law's at the step's end.
template <class Vec>
struct FrictionErrorOf {
  double difference = 0.0, limit = 0.0;                ///< over samples, sizes of forces [N]
  Vec left_out = Vec::Zero(), friction = Vec::Zero();  ///< sums of forces [N]
  /// @param taken  force of the line at the end  @param limit  L there  @param v  there
  void add(const Vec& taken, double limit_there, const Vec& v, double v_r) {
    const Vec law = friction_force(limit_there, v, v_r);
    difference += (law - taken).norm();
    limit += limit_there;
    left_out += law - taken;
    friction += law;
  }
  /// Relative; 0 where nothing presses.
  double relative() const { return difference > 0.0 ? (limit > 0.0 ? difference / limit : 1.0) : 0.0; }
};
using FrictionError = FrictionErrorOf<Vec3>;

}  // namespace palpate::contact
