#pragma once
#include <memory>
#include <string>
#include <vector>

#include "palpate/core/pose.h"
#include "palpate/dynamics/linearised_contact.h"
#include "palpate/dynamics/rigid_body.h"
#include "palpate/dynamics/stepper.h"
#include "palpate/tool/spec.h"
#include "palpate/tool/tick.h"

namespace palpate::tool {

/// Rigid tool: a Simbody MobilizedBody::Free under a 6-DoF virtual coupling and a linearised contact
/// (docs/theory/haptic-loop.md). The Simbody System is hidden behind the pimpl.
class Tool {
 public:
  /// Builds the tool at the pose of the spec, at rest at time 0.
  /// @param spec  the [tool] table, checked
  /// @param gravity  [m/s^2], world axes; applies only if spec.gravity is set
  /// @throws Error for a parameter out of range or an unknown integrator, and in a build without Simbody
  Tool(const ToolSpec& spec, const Vec3& gravity);
  ~Tool();
  /// Moves the tool; the moved-from tool may only be destroyed.
  Tool(Tool&&) noexcept;

  /// Returns the end of the last tick [s].
  double time() const;
  /// Returns the pose of the tool's frame in the world; the origin is the centre of mass.
  Pose pose() const;
  /// Returns the twist of the tool's origin, in world axes.
  Twist twist() const;
  /// Sets time [s], pose and twist, and resets the integrator's history. All values must be finite.
  void set_state(double t, const Pose& pose, const Twist& twist);

  /// Advances the tool by one tick of `h` seconds, with the scheme that the spec specifies and the contact
  /// wrench linear about its record. On failure the state is unchanged.
  dynamics::StepResult advance(double h, const HandleMotion& handle,
                               const dynamics::LinearisedContact& contact);

  /// Returns the equation of a linearly-implicit-euler tick, whichever integrator the spec specifies. Does
  /// not change the tool.
  StepEquation step_equation(double h, const HandleMotion& handle,
                             const dynamics::LinearisedContact& contact) const;
  /// Returns the motion at the end of that tick.
  /// @param h  length of the tick [s]  @param change  solution du of the equation
  dynamics::RigidMotion after(double h, const Vec6& change) const;

  /// Returns the wrench of the coupling on the tool about the tool's origin, for a handle pose, before any
  /// limit.
  Wrench coupling_wrench(const Pose& handle, const Twist& handle_twist) const;
  /// Returns the wrench of the coupling on the hand: opposite force, and moment about the handle's origin.
  Wrench wrench_on_hand(const Pose& handle, const Twist& handle_twist) const;

  /// Computes K = -dF/dx and B = -dF/dv of the coupling at the current pose (6x6, angular first), to be added
  /// to the tool's rows by `condensed` linearisations and monolithic coupling.
  void coupling_tangent(const Pose& handle, const Twist& handle_twist, Mat6& K, Mat6& B) const;
  Mat6 mass_matrix() const;  ///< At the current pose, world axes, about the origin.
  /// Returns the kinetic energy [J].
  double kinetic_energy() const;
  double potential_energy(const Pose& handle) const;  ///< Coupling to a handle, and weight [J].
  double coupling_energy(const Pose& handle) const;   ///< Springs of the coupling to a handle [J].

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Name, summary and order of one integrator of the tool's ticks.
struct ToolIntegratorInfo {
  std::string name, summary;  ///< Name in scenes, and a one-line description.
  int order;                  ///< Theoretical order in the tick length.
};
/// Returns all tool integrators, in the order of `palpate list tool-integrators`.
const std::vector<ToolIntegratorInfo>& tool_integrators();

/// Returns whether this build includes Simbody; without it there are no tools and no jointed bones.
bool available();
/// Returns the version of Simbody in this build; empty without Simbody.
std::string simbody_version();

}  // namespace palpate::tool
