#pragma once
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/contact/spec.h"
#include "palpate/device/spec.h"
#include "palpate/dynamics/spec.h"
#include "palpate/fem/spec.h"
#include "palpate/store/spec.h"
#include "palpate/tool/spec.h"

namespace palpate::scene {

/// Refinement sequence of a work-precision diagram: one integrator with several tolerances or steps.
struct LadderSpec {
  std::string integrator;  ///< Name as in `palpate list integrators`.
  /// Meaning of `values`: "rtol" for adaptive methods, "step_s" for fixed-step ones.
  std::string setting = "rtol";
  std::vector<double> values;      ///< In descending order.
  std::string label{};             ///< Name in reports; empty: the integrator's name.
  std::vector<std::string> set{};  ///< Further changes of the scene: KEY=VALUE, as for `--set`.
};

/// Settings of `palpate compare --haptic`, the `[compare.haptic]` table: parameters of the scene that are
/// varied one at a time, and the monolithic reference solution (tool and bodies in one system) for the force
/// on the hand.
struct HapticCompareSpec {
  std::string reference = "cvode-bdf";  ///< Integrator of the monolithic solution.
  /// Integrator of another family that checks the reference; empty: chosen automatically.
  std::string reference_check;
  double reference_rtol = 1e-7;       ///< Tolerance of the reference, for error control.
  double reference_step_s = 5e-4;     ///< Step of the reference, for fixed steps [s].
  double reference_refresh_s = 5e-4;  ///< Contact refresh period of the reference [s].
  std::vector<double> exchange_periods_s = {0.05,  0.02,  0.01,
                                            0.005, 0.002, 0.001};  ///< Varied; all else as in the scene [s].
  std::vector<double> ticks_s = {0.002, 0.001, 5e-4, 2e-4, 1e-4};  ///< Varied; all else as in the scene [s].
  /// Pixels along the longer edge of the images of the tool's contacts, if there are any.
  std::vector<double> pixels = {32, 64, 128, 256};
  /// Applies to every body that a generator meshes [m]; empty: only the scene's.
  std::vector<double> element_sizes_m;
  /// Varied; all else as in the scene.
  std::vector<std::string> integrators = {"linearly-implicit-euler", "implicit-midpoint", "cvode-bdf"};
  std::vector<std::string> linearisations;  ///< Values of exchange.linearisation; empty: all.
};

/// Settings of `palpate compare`, the `[compare]` table.
struct CompareSpec {
  std::vector<LadderSpec> ladders;  ///< One for each method compared.
  /// For the convergence chart of the exchange error [s]; empty: none.
  std::vector<double> exchange_periods_s;
  std::string reference = "cvode-bdf";        ///< Integrator of the reference solution.
  double reference_rtol = 1e-9;               ///< Tolerance of the reference.
  std::string reference_check = "ark-erk-5";  ///< Integrator of another family that checks the reference.
  double reference_check_rtol = 1e-8;         ///< Tolerance of the check.
  /// Methods of contact detection for the tool, compared with the first; empty: none.
  std::vector<std::string> contact_methods;
  /// Contact refresh periods for which the cost of re-initialisation is measured [s]; empty: none.
  std::vector<double> refresh_periods_s;
  double duration_s = 0.0;   ///< Simulated time [s]; 0: the scene's.
  HapticCompareSpec haptic;  ///< Settings of `--haptic`.
};

/// Coupling of tools and bodies: tools step separately, at the haptic rate, and exchange contact records with
/// the bodies; tools are blocks of the State, and one integrator advances everything, with the handle's path
/// known in advance; the same with a sampled handle and one advance of everything per haptic tick; or the
/// last, where the machine holds its rate, else the first.
enum class ExchangeScheme { kPartitioned, kMonolithic, kSingleRate, kAuto };
/// Returns the names of the values.
constexpr std::array<std::string_view, 4> option_names(ExchangeScheme) {
  return {"partitioned", "monolithic", "single_rate", "auto"};
}

/// Treatment of bodies that may pass through each other between two refreshes of contact: count the events,
/// or refresh contact and exchange before a skin has penetrated the other body by more than half of its
/// thickness.
enum class TunnellingPolicy { kReport, kSubstep };
/// Returns the names of the values.
constexpr std::array<std::string_view, 2> option_names(TunnellingPolicy) { return {"report", "substep"}; }

/// Coupling of tools and bodies in time: the `[exchange]` table.  Not to be confused with the virtual
/// coupling between hand and tool (ToolSpec).
struct CosimulationSpec {
  ExchangeScheme scheme = ExchangeScheme::kPartitioned;  ///< Coupling of tools and bodies.
  /// Model of the bodies between exchanges: "points", contact points on a reduced model of the bodies'
  /// response; or a linear model: "condensed", including the bodies' response, or "frozen", with the bodies
  /// at rest.
  std::string linearisation = "points";
  /// Acceptance limit of "points": relative error of the reduced bodies' response, which is too stiff; 0: no
  /// reduction.
  double linearisation_error = 0.1;
  double exchange_period_s = 0.01;  ///< Period of exchange between tool and bodies [s].
  /// Contact refresh period [s]: an integer fraction of the exchange period, or, for
  /// ExchangeScheme::kSingleRate, a whole number of ticks.
  double contact_refresh_s = 0.01;
  TunnellingPolicy tunnelling = TunnellingPolicy::kReport;  ///< Treatment of possible tunnelling.
  double shortest_refresh_s =
      1e-5;  ///< Lower limit of the refresh period for TunnellingPolicy::kSubstep [s].
  /// Number of ticks from an exchange to the first tick that uses its result, in virtual time; models the
  /// computation time of a real-time run.
  int latency_ticks = 0;

  /// Returns whether tools are blocks of the State.
  bool has_tools_in_state() const {
    return scheme == ExchangeScheme::kMonolithic || scheme == ExchangeScheme::kSingleRate;
  }
};

/// Additional hand: a `[[hand]]` table of the scene.
struct HandSpec {
  std::string name;   ///< Name of its tool in [[contact]].
  ToolSpec tool;      ///< Table [hand.tool].
  DeviceSpec device;  ///< Table [hand.device].
};

/// View of pictures, movies and pages: the `[view]` table.
struct ViewSpec {
  std::optional<Vec3> direction;  ///< From the scene to the eye, not zero; empty: chosen by the picture.
  std::optional<Vec3> target_m;   ///< Point in the middle of the picture [m]; empty: the middle of the scene.
  double zoom = 1.0;              ///< Magnification; 1 shows the whole scene.
  Vec3 up = Vec3::UnitZ();        ///< Upward direction of the picture, not zero.
};

/// Scene file as plain data: everything that a run needs, nothing computed.  A part that is absent here is
/// not built.
struct Description {
  std::string name;                  ///< Title of the scene.
  std::string path;                  ///< Source file; relative mesh paths start at its folder.
  std::string source;                ///< Text of the file with overrides applied, stored with every result.
  double duration_s = 1.0;           ///< Default simulated time of a run [s].
  Vec3 gravity_m_s2 = Vec3::Zero();  ///< Acts on bodies, bones, and tools with `gravity` [m/s^2].
  std::vector<SoftBodySpec> bodies;  ///< Tables [[body]].
  std::vector<BoneSpec> bones;       ///< Tables [[bone]].
  std::vector<ObstacleSpec> obstacles;  ///< Tables [[obstacle]].
  std::vector<ContactSpec> contacts;    ///< Tables [[contact]].
  std::optional<ToolSpec> tool;         ///< Table [tool].
  std::optional<DeviceSpec> device;     ///< Table [device].
  std::vector<HandSpec> hands;  ///< Tables [[hand]], in addition to the first hand (`tool` and `device`).
  CosimulationSpec exchange;    ///< Table [exchange].
  IntegratorSpec integrator;    ///< Table [integrator].
  std::optional<RecordSpec> record;  ///< Table [record]; empty: nothing is recorded.
  CompareSpec compare;               ///< Table [compare].
  ViewSpec view;                     ///< Table [view].
  /// Keys of the file that apply only to an integrator (obstacle, method, ...) replaced by an override:
  /// "integrator.rtol"; they are not in `source`.
  std::vector<std::string> not_carried_over;
};

}  // namespace palpate::scene
