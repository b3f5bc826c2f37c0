#pragma once
#include <utility>
#include <vector>

#include "scene_run.h"

namespace palpate::stability {

/// Edge of the cube, radius of the ball [m]; exchange period [s].
inline constexpr double kToolCubeEdge = 0.05, kToolRadius = 0.01, kToolPeriod = 0.01;

/// Returns the scene of soft_cube(), with 27 nodes (one under the ball) and held below, under a rigid ball on
/// a coupling.
/// @param heights keyframes of the handle: time [s], z of the ball's centre [m]; the ball starts at the first
/// @param mass mass of the ball [kg]
/// @param stiffness of the coupling [N/m]
/// @param damping of the coupling [N s/m]
/// @param period exchange period [s]
scene::Description under_a_tool(const std::vector<std::pair<double, double>>& heights, double mass,
                                double stiffness, double damping, double period = kToolPeriod);

}  // namespace palpate::stability
