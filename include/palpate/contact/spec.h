#pragma once
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/core/keys.h"

namespace palpate {

/// Rigid shape fixed in the world, with exact gaps. Corresponds to an `[[obstacle]]` table of a scene.
struct ObstacleSpec {
  std::string name;  ///< Name, unique in the scene.
  std::string type;  ///< Type in contact::obstacle_registry(), which defines the keys of the shape.
  /// All other keys, e.g. `shape["radius_m"] = 0.1`; absent keys have the registry's defaults.
  Settings shape = {};
};

/// Tangent of friction.
enum class FrictionTangent {
  kAuto,       ///< kSecant where a step is one linear solve, else kFull.
  kFull,       ///< All derivatives.
  kSecant,     ///< Like kSymmetric, with the friction of the step's end, found by repeated solves.
  kSymmetric,  ///< Without the derivative of friction with respect to pressure, which is unsymmetric.
};
/// Returns the names of the values.
constexpr std::array<std::string_view, 4> option_names(FrictionTangent) {
  return {"auto", "full", "secant", "symmetric"};
}

/// Pair of bodies that may touch. Corresponds to a `[[contact]]` table of a scene.
struct ContactSpec {
  /// Names of bodies, obstacles or "tool", in any order; the same body twice: self-contact.
  std::string first, second;
  /// "distance" (nearest points), "analytic" (samples at vertices; for an obstacle or a sphere tool), "image"
  /// (image space, samples at vertices; for a tool of any shape or another soft body), or "auto"
  /// (scene/contact_sides.h).
  std::string method = "auto";
  /// "per_area": pressure as a function of depth, times the area that a sample represents. "per_point": force
  /// as a function of depth at each colliding vertex (Galoppo et al. 2007), so that twice as many vertices
  /// give twice the force.
  std::string spring = "per_area";
  double stiffness_pa_m = 1e7;       ///< k for per_area: pressure per depth [Pa/m].
  double stiffness_n_m = 100.0;      ///< k for per_point: force per depth [N/m].
  double damping_pa_s_m = 0.0;       ///< d for per_area (kelvin_voigt) [Pa s/m].
  double damping_n_s_m = 0.0;        ///< d for per_point (kelvin_voigt) [N s/m].
  double hunt_crossley_s_m = 0.0;    ///< c (hunt_crossley) [s/m].
  std::string law = "kelvin_voigt";  ///< "kelvin_voigt" or "hunt_crossley".
  /// w: depth over which the pressure sets in smoothly (C1) [m]; 0: immediately, with a kink.
  double onset_width_m = 0.0;
  double friction = 0.0;  ///< mu, regularised Coulomb friction [-].
  /// v_r [m/s]; 0: chosen by a scene from its size and gravity, otherwise 1 mm/s.
  double friction_regularisation_m_s = 0.0;
  /// True: springs between material points hold sticking contacts. False: sticking contacts creep at less
  /// than v_r.
  bool friction_anchors = true;
  /// tau: damping of these springs divided by their stiffness [s]; in a scene the time between two queries.
  /// 0: no springs.
  double friction_retardation_s = 0.0;
  FrictionTangent friction_tangent = FrictionTangent::kAuto;  ///< Tangent of friction.
  /// Samples with a smaller positive gap are kept as candidates [m]; 0: chosen from the mesh.
  double candidate_gap_m = 0.0;
  int pixels = 64;  ///< Image space: pixels along the longer edge of the image.
  /// Nearest points: target relative quadrature error of the force due to the number of points, for a contact
  /// whose depth is an eighth of its radius.
  double quadrature_error = 1e-2;
};

/// Permitted ranges of these parameters, checked by the scene loader and by the pressure law.
struct ContactRanges {
  /// [Pa/m]
  static constexpr Range stiffness_pa_m =
      Range::positive("a good start is 10 x Young's modulus / size of the indentation");
  /// [N/m]
  static constexpr Range stiffness_n_m =
      Range::positive("a good start is stiffness_pa_m times the area per vertex");
  static constexpr Range damping_pa_s_m = Range::at_least(0.0);     ///< [Pa s/m]
  static constexpr Range damping_n_s_m = Range::at_least(0.0);      ///< [N s/m]
  static constexpr Range hunt_crossley_s_m = Range::at_least(0.0);  ///< [s/m]
  /// [m]
  static constexpr Range onset_width_m =
      Range::at_least(0.0, "0 gives an immediate onset with a kink, a tenth of the depth a smooth one");
  static constexpr Range friction = Range::at_least(0.0);  ///< [-]
  /// [m/s]
  static constexpr Range friction_regularisation_m_s = Range::at_least(
      0.0, "below this sliding speed friction is viscous; with 0 it is chosen from the scene");
  /// [m]
  static constexpr Range candidate_gap_m = Range::at_least(0.0, "with 0 it is chosen from the mesh");
  static constexpr Range pixels = Range::closed(16, 4096);  ///< Along the longer edge of an image.
  /// Relative error of a contact's force; the spacing of points is proportional to its square root.
  static constexpr Range quadrature_error = Range::closed(1e-6, 0.1, "1e-2 is the default");
};

}  // namespace palpate
