#pragma once
#include <string>
#include <vector>

#include "palpate/core/keys.h"

namespace palpate {

/// A rigid shape fixed in the world, with exact gaps.  The `[[obstacle]]` tables of a scene.
struct ObstacleSpec {
  std::string name;  ///< unique in the scene
  std::string type;  ///< of contact::obstacle_registry(), which says what its shape is made of
  /// all other keys: `shape["radius_m"] = 0.1`; what is not given has the default of the registry
  Settings shape = {};
};

/// One pair that may touch.  The `[[contact]]` tables of a scene.
struct ContactSpec {
  /// names of bodies, obstacles or "tool", in any order; one body twice: against itself
  std::string first, second;
  /// "distance" (nearest points), "analytic" (at vertices; of an obstacle or a sphere tool), "image" (in
  /// image space, at vertices; of a tool of any shape or another soft body), or "auto"
  /// (scene/contact_sides.h)
  std::string method = "auto";
  /// "per_area": pressure by depth, times the area that a sample stands for; "per_point": a force by depth at
  /// each colliding vertex (Galoppo et al. 2007), so that twice the vertices push twice as hard
  std::string spring = "per_area";
  double stiffness_pa_m = 1e7;       ///< k of per_area: pressure per depth
  double stiffness_n_m = 100.0;      ///< k of per_point: force per depth
  double damping_pa_s_m = 0.0;       ///< d of per_area (kelvin_voigt) [Pa s/m]
  double damping_n_s_m = 0.0;        ///< d of per_point (kelvin_voigt) [N s/m]
  double hunt_crossley_s_m = 0.0;    ///< c (hunt_crossley) [s/m]
  std::string law = "kelvin_voigt";  ///< or "hunt_crossley"
  /// w: depth over which the pressure sets in smoothly (C1); 0: at once, with a kink
  double onset_width_m = 0.0;
  double friction = 0.0;                     ///< mu, regularised Coulomb
  double friction_regularisation_m_s = 0.0;  ///< v_r; 0: of a scene by its size and gravity, else 1 mm/s
  /// whether what sticks is held by springs between material points; else it creeps, at less than v_r
  bool friction_anchors = true;
  /// tau: the damping of these springs over their stiffness, of a scene the time between two queries; 0:
  /// there are none [s]
  double friction_retardation_s = 0.0;
  /// "full"; "symmetric": without how friction follows pressure, which is unsymmetric; "secant": so, and
  /// friction is that of a step's end, by repeated solves; "auto": secant where a step is one linear solve
  std::string friction_tangent = "auto";
  /// samples with a smaller positive gap are kept too; 0: chosen from the mesh
  double candidate_gap_m = 0.0;
  int pixels = 64;  ///< in image space: the image's longer edge
  /// of nearest points: what their number may err in the force, relative, of a contact an eighth as deep as
  /// its radius
  double quadrature_error = 1e-2;
};

/// What they may be: checked by the loader of scenes and by the pressure law.
struct ContactRanges {
  /// [Pa/m]
  static constexpr Range stiffness_pa_m =
      Range::positive("10 x Young's modulus / the size of the dent is a start");
  /// [N/m]
  static constexpr Range stiffness_n_m =
      Range::positive("stiffness_pa_m times the area of a vertex is a start");
  static constexpr Range damping_pa_s_m = Range::at_least(0.0);     ///< [Pa s/m]
  static constexpr Range damping_n_s_m = Range::at_least(0.0);      ///< [N s/m]
  static constexpr Range hunt_crossley_s_m = Range::at_least(0.0);  ///< [s/m]
  /// [m]
  static constexpr Range onset_width_m =
      Range::at_least(0.0, "0 lets the pressure set in at once; a tenth of the depth is a smooth onset");
  static constexpr Range friction = Range::at_least(0.0);  ///< coefficient of friction [1]
  /// [m/s]
  static constexpr Range friction_regularisation_m_s =
      Range::at_least(0.0, "below this sliding speed friction is viscous; 0 lets the scene choose");
  /// [m]
  static constexpr Range candidate_gap_m = Range::at_least(0.0, "0 lets the mesh choose");
  static constexpr Range pixels = Range::closed(16, 4096);  ///< along an image's longer edge
  /// relative, of a contact's force: a spacing of points goes with its root
  static constexpr Range quadrature_error = Range::closed(1e-6, 0.1, "1e-2 is the default");
};

}  // namespace palpate
