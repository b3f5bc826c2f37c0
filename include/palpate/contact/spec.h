#pragma once
#include <string>
#include <vector>

#include "palpate/core/types.h"

namespace palpate {

/// A rigid shape fixed in the world, with exact gaps.  The `[[obstacle]]` tables of a scene.
struct ObstacleSpec {
  std::string name;
  std::string type;                         ///< "plane", "sphere", "box", "cylinder"
  Vec3 position_m = Vec3::Zero();           ///< a point of the plane; the centre of the others
  Vec3 normal = Vec3::UnitZ();              ///< plane: outward
  Vec3 rotation_vector_rad = Vec3::Zero();  ///< box, cylinder: from the axes of the world to its own
  Vec3 size_m = Vec3::Ones();               ///< box: its three edges
  double radius_m = 1.0;                    ///< sphere, cylinder
  double length_m = 1.0;                    ///< cylinder: along its own z, between flat ends
};

/// One pair that may touch.  The `[[contact]]` tables of a scene.
struct ContactSpec {
  std::string first;  ///< a body's name
  /// an obstacle's name, "tool", another body's (method "gpu"), or the same again: its bones' regions against
  /// each other (proxies)
  std::string second;
  /// "analytic" (obstacle or a sphere tool) or "gpu" (image space: a tool of any shape, another soft body)
  std::string method = "analytic";
  double stiffness_pa_m = 1e7;       ///< k: pressure per depth
  double damping_pa_s_m = 0.0;       ///< d (kelvin_voigt) [Pa s/m]
  double hunt_crossley_s_m = 0.0;    ///< c (hunt_crossley) [s/m]
  std::string law = "kelvin_voigt";  ///< or "hunt_crossley"
  /// w: depth over which the pressure sets in smoothly (C1); 0: at once, with a kink
  double onset_width_m = 0.0;
  double friction = 0.0;                      ///< mu, regularised Coulomb
  double friction_regularisation_m_s = 1e-3;  ///< v_r
  /// samples with a smaller positive gap are kept too; 0: chosen from the mesh
  double candidate_gap_m = 0.0;
  int pixels = 256;  ///< gpu: the image's edge
};

}  // namespace palpate
