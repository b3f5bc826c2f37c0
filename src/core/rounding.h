#pragma once
#include <limits>

namespace palpate {

/// Returns the torque that rounding leaves where the exact one is zero [N m].  A torque is a sum of terms
/// r x f, in which each arm r is a difference of world coordinates of size L and therefore wrong by up to
/// eps L; forces that add up to F give eps L F.  The sum of n terms adds about sqrt(n) roundings of the same
/// size; 32 of them is the sum over a contact of a thousand points.
/// @param force_n  largest force [N]
/// @param size_m  size of the coordinates: bodies and tools, from the world's origin [m]
inline double torque_rounding(double force_n, double size_m) {
  constexpr double kRoundings = 32.0;
  return kRoundings * std::numeric_limits<double>::epsilon() * force_n * size_m;
}

}  // namespace palpate
