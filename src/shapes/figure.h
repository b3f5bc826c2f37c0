#pragma once
#include "palpate/core/types.h"
#include "palpate/mesh/skeleton.h"

/// Joints of the standing figure, left side (x > 0), metres.  The limbs of its tissue and its bones share
/// these points.  Proportions: 1.75 m, seven and a half heads of 0.233 m; segment lengths as shares of the
/// height after Drillis and Contini 1966 (in Winter, "Biomechanics and Motor Control of Human Movement"):
/// upper arm 0.172 (0.186 there, to the shoulder's outer end), forearm 0.146, thigh 0.241, shank 0.246; feet
/// 0.26 m long.
namespace palpate::shapes::figure {

constexpr double kHeight = 1.75, kHead = kHeight / 7.5;

inline const Vec3 kPelvis(0, 0.012, 0.940), kWaist(0, 0.020, 1.060), kChest(0, 0.026, 1.210),
    kNeck(0, 0.032, 1.468), kSkull(0, 0.004, 1.560);
inline const Vec3 kCollar(0.022, 0.005, 1.432), kShoulder(0.172, 0.014, 1.412), kElbow(0.312, 0.022, 1.146),
    kWrist(0.424, -0.022, 0.919);
inline const Vec3 kKnuckles(0.4565, -0.0350, 0.835);
inline const Vec3 kHip(0.088, 0.008, 0.905), kKnee(0.112, -0.006, 0.495), kAnkle(0.128, 0.020, 0.082),
    kToes(0.158, -0.150, 0.022), kHeel(0.127, 0.050, 0.030);

/// Builds 19 bones, parents before children, left and right mirror images; each capsule lies inside the
/// tissue.
Skeleton skeleton();

}  // namespace palpate::shapes::figure
