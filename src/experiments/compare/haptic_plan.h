#pragma once
#include "experiments/compare/haptic_comparison.h"

namespace palpate::compare {

// Variables of a haptic comparison, as named in tables and charts.
inline constexpr const char* kPeriod = "exchange period";
inline constexpr const char* kAlone = "exchange alone";
inline constexpr const char* kTick = "tick";
inline constexpr const char* kPixels = "pixels";
inline constexpr const char* kElement = "element size";
inline constexpr const char* kIntegrator = "integrator";
inline constexpr const char* kScheme = "scheme";
inline constexpr const char* kLinearisation = "linearisation";

/// Returns all points of a scene, variable by variable, each with its description; a point that the loader
/// rejects has status kRefused.  The scene's value is one point of exchange period, tick, element
/// size, integrator, scheme and linearisation. A single-rate scene has no points of exchange period, exchange
/// alone and linearisation.
/// @param integrators  replaces the scene's list; empty: the list
std::vector<HapticPoint> plan_haptic(const scene::Description& description,
                                     const std::vector<std::string>& integrators);

/// Returns fitted orders of the variables that have one, from points that the reference resolves and whose
/// error is within kOrderPeakShare of the peak.
std::vector<HapticOrder> haptic_orders(const HapticComparison& comparison);

/// Marks one point that the reference does not resolve, and computes its median time.
void summarise(HapticPoint& point, const TrajectoryError& own);

}  // namespace palpate::compare
