#pragma once
#include <optional>
#include <string>
#include <vector>

#include "palpate/contact/spec.h"
#include "palpate/device/spec.h"
#include "palpate/dynamics/spec.h"
#include "palpate/fem/spec.h"
#include "palpate/store/spec.h"
#include "palpate/tool/spec.h"

namespace palpate::scene {

/// One point of a work-precision ladder is an integrator with its tolerances or steps.
struct LadderSpec {
  std::string integrator;  ///< as `palpate list integrators` names it
  /// which setting `values` are: "rtol" of adaptive methods, "step_s" of fixed-step ones
  std::string setting = "rtol";
  std::vector<double> values;      ///< descending
  std::string label{};             ///< what reports call it; empty: the integrator's name
  std::vector<std::string> set{};  ///< what else is changed in the scene for it: KEY=VALUE, as for `--set`
};

/// What `palpate compare --haptic` varies about the scene, one at a time, and the run with tool and bodies as
/// one system that the force on the hand is held against: the `[compare.haptic]` table.
struct HapticCompareSpec {
  std::string reference = "cvode-bdf";  ///< the integrator of tool and bodies as one system
  /// the integrator, of another family, that checks it; empty: one is chosen
  std::string reference_check;
  double reference_rtol = 1e-7;       ///< of the reference, under error control
  double reference_step_s = 5e-4;     ///< of the reference, in fixed steps
  double reference_refresh_s = 5e-4;  ///< contact refresh of the reference
  std::vector<double> exchange_periods_s = {0.05,  0.02,  0.01,
                                            0.005, 0.002, 0.001};  ///< each in turn, all else as in the scene
  std::vector<double> ticks_s = {0.002, 0.001, 5e-4, 2e-4, 1e-4};  ///< each in turn, all else as in the scene
  /// along the longer edge of the images of the tool's contacts, where it has any
  std::vector<double> pixels = {32, 64, 128, 256};
  std::vector<double> element_sizes_m;  ///< of every body that a generator meshes; empty: the scene's alone
  /// each in turn, all else as in the scene
  std::vector<std::string> integrators = {"linearly-implicit-euler", "implicit-midpoint", "cvode-bdf"};
  std::vector<std::string> linearisations;  ///< empty: every one that there is
};

/// What `palpate compare` does with this scene.
struct CompareSpec {
  std::vector<LadderSpec> ladders;         ///< one for each method that is compared
  std::vector<double> exchange_periods_s;  ///< for the chart of the exchange period's own error; empty: none
  std::string reference = "cvode-bdf";     ///< the integrator that makes the reference
  double reference_rtol = 1e-9;            ///< of the reference
  std::string reference_check = "ark-erk-5";  ///< the integrator of another family that checks the reference
  double reference_check_rtol = 1e-8;         ///< of the check
  /// ways to find the tool's contact, compared with the first; empty: none
  std::vector<std::string> contact_methods;
  /// contact refreshes at which the price of re-initialisation is counted; empty: none
  std::vector<double> refresh_periods_s;
  double duration_s = 0.0;   ///< 0: the scene's
  HapticCompareSpec haptic;  ///< what `--haptic` varies
};

/// How tool and bodies are simulated together: the `[exchange]` table.  The spring between hand and tool is
/// another thing, ToolSpec's virtual coupling.
struct CosimulationSpec {
  /// or "monolithic": tool and bodies in one state of one integrator, nothing exchanged
  std::string scheme = "partitioned";
  /// what ticks know of the bodies: "points", contact points over a reduced model of their answer; or a line:
  /// "condensed", with their answer, "frozen", of bodies that hold still
  std::string linearisation = "points";
  /// of "points": by how much at most the reduced bodies are stiffer than they should be, relative; 0: not
  double linearisation_error = 0.1;
  double exchange_period_s = 0.01;  ///< between tool and bodies
  double contact_refresh_s = 0.01;  ///< a whole fraction of the exchange period
  /// what is done about bodies so fast that they may go through each other between two refreshes: counted,
  /// or "substep": contact is refreshed, and exchanged, before a skin has gone farther into what it touches
  /// than half of its thickness
  std::string tunnelling = "report";
  double shortest_refresh_s = 1e-5;  ///< "substep" goes no lower
  /// ticks from an exchange to the first that uses its result, in virtual time: what computing takes in real
  /// time
  int latency_ticks = 0;
};

/// One more hand: a `[[hand]]` table of the scene.
struct HandSpec {
  std::string name;   ///< what [[contact]] calls its tool
  ToolSpec tool;      ///< [hand.tool]
  DeviceSpec device;  ///< [hand.device]
};

/// A scene file as plain data: everything a run needs, nothing computed.  A part that is absent here is not
/// built.
struct Description {
  std::string name;                     ///< of the scene, for people
  std::string path;                     ///< the file it came from; relative mesh paths start at its folder
  std::string source;                   ///< the file's text with overrides applied, kept with every result
  double duration_s = 1.0;              ///< of a run, unless it is told another
  Vec3 gravity_m_s2 = Vec3::Zero();     ///< acts on bodies, bones, and tools that ask for it
  std::vector<SoftBodySpec> bodies;     ///< the [[body]] tables
  std::vector<BoneSpec> bones;          ///< the [[bone]] tables
  std::vector<ObstacleSpec> obstacles;  ///< the [[obstacle]] tables
  std::vector<ContactSpec> contacts;    ///< the [[contact]] tables
  std::optional<ToolSpec> tool;         ///< the [tool] table
  std::optional<DeviceSpec> device;     ///< the [device] table
  std::vector<HandSpec> hands;          ///< beside that of `tool` and `device`, which is the first
  CosimulationSpec exchange;            ///< the [exchange] table
  IntegratorSpec integrator;            ///< the [integrator] table
  std::optional<RecordSpec> record;     ///< the [record] table; empty: nothing is kept
  CompareSpec compare;                  ///< the [compare] table
  /// keys of the file's own integrator (obstacle, method, ...) that the one which an override named has no
  /// use for: "integrator.rtol"; they are not in `source`
  std::vector<std::string> not_carried_over;
};

}  // namespace palpate::scene
