#pragma once
#include "palpate/compare/haptic.h"

namespace palpate::compare {

// Variables of a haptic comparison, as tables and charts call them.
inline constexpr const char* kPeriod = "exchange period";
inline constexpr const char* kAlone = "exchange alone";
inline constexpr const char* kTick = "tick";
inline constexpr const char* kPixels = "pixels";
inline constexpr const char* kElement = "element size";
inline constexpr const char* kIntegrator = "integrator";
inline constexpr const char* kLinearisation = "linearisation";

/// All points of a scene, variable by variable, each with its description; what the loader refuses is a
/// point of status kRefused.  The scene's own setting is a point of every variable.
/// @param integrators  only these, in place of the scene's list; empty: the list
std::vector<HapticPoint> plan_haptic(const scene::Description& description,
                                     const std::vector<std::string>& integrators);

/// Fitted orders of the variables that have one, from the points that the reference resolves and whose error
/// is within kOrderPeakShare of the peak.
std::vector<HapticOrder> haptic_orders(const HapticComparison& comparison);

/// Marks the points that the reference does not resolve, and takes medians.
void summarise(HapticPoint& point, const TrajectoryError& own);

}  // namespace palpate::compare
