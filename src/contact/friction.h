#pragma once
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
Vec3 friction_force(double limit, const Vec3& v, double v_r);

/// Guess of how a sample slides at the end of a step, improved from solve to solve (friction.cpp).
struct FrictionGuess {
  /// How the law is made affine about the guess.
  enum class Kind : int {
    kSticks,  ///< viscous, as below v_r
    kSlides,  ///< its tangent: constant along the sliding
    kSecant,  ///< its secant through zero
  };
  Kind kind = Kind::kSticks;
  double limit = 0.0;     ///< L [N]
  Vec3 v = Vec3::Zero();  ///< tangential velocity [m/s]
};

/// The first guess: the step ends as it begins.
FrictionGuess first_guess(double limit, const Vec3& v, double v_r);
/// The guess after a solve.
/// @param last   the guess that the solve took  @param limit  L at the end that it found  @param v  there
/// @param solves  done so far in this step
FrictionGuess next_guess(const FrictionGuess& last, double limit, const Vec3& v, double v_r, int solves);
/// @param n  unit normal, across which v lies
FrictionLine friction_line(const FrictionGuess& guess, const Vec3& n, double v_r);

/// Solves of a step, at most, and the difference between the friction that a step took and the law's at its
/// end that it may leave, of the largest that the law allows: below a thousandth of mu N.
inline constexpr int kFrictionSolves = 10;
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
