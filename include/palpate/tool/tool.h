#pragma once
#include <memory>
#include <string>

#include "palpate/core/pose.h"
#include "palpate/core/registry.h"
#include "palpate/dynamics/exchange.h"
#include "palpate/dynamics/rigid_body.h"
#include "palpate/dynamics/stepper.h"
#include "palpate/tool/spec.h"

namespace palpate::tool {

/// The handle's motion over one tick, as the coupling sees it: pose and twist at the tick's end (implicit
/// schemes) and start.
struct HandleMotion {
  Pose pose0, pose1;     ///< at the start and at the end of the tick
  Twist twist0, twist1;  ///< likewise
};

/// One step of a tool by linearly implicit Euler's method: A du = r, du the change of its twist, angular
/// first [rad/s, m/s].
struct StepEquation {
  Mat6 A = Mat6::Zero();  ///< M + h B + h^2 K, gyroscopic terms included
  Vec6 r = Vec6::Zero();  ///< [N m s, N s]
};

/// A Simbody MobilizedBody::Free under a 6-DoF virtual coupling and a linearised contact
/// (docs/design.md, 4.5).  The Simbody System stays behind the pimpl.
class Tool {
 public:
  /// @param spec  the [tool] table, checked  @param gravity  [m/s^2], world axes; acts where the spec says so
  Tool(const ToolSpec& spec, const Vec3& gravity);
  ~Tool();
  /// Moved from, it may only be destroyed or assigned to.
  Tool(Tool&&) noexcept;

  /// End of the last tick [s].
  double time() const;
  /// Of the tool's frame in the world: origin at its centre of mass.
  Pose pose() const;
  /// In world axes, of its origin.
  Twist twist() const;
  /// Puts it there at time t [s], as if it had come so.
  void set_state(double t, const Pose& pose, const Twist& twist);

  /// One tick of `h` seconds with the contact linear about its record, by the scheme that the spec names.
  dynamics::StepResult advance(double h, const HandleMotion& handle,
                               const dynamics::LinearisedContact& contact);

  /// Returns the equation of a tick by linearly-implicit-euler, whatever the spec names; nothing changes.
  StepEquation step_equation(double h, const HandleMotion& handle,
                             const dynamics::LinearisedContact& contact) const;
  /// Returns where that tick leads.
  /// @param h  its length [s]  @param change  solution of the equation
  dynamics::RigidMotion after(double h, const Vec6& change) const;

  /// Wrench that the coupling exerts on the tool about its origin, for a handle pose (before any limit).
  Wrench coupling_wrench(const Pose& handle, const Twist& handle_twist) const;
  /// The coupling wrench on the hand: force opposite, moment about the handle's origin.
  Wrench wrench_on_hand(const Pose& handle, const Twist& handle_twist) const;

  /// K = -dF/dx and B = -dF/dv of the coupling at the current pose (6x6, angular first): added to the tool's
  /// rows by `condensed` linearisations and monolithic coupling.
  void coupling_tangent(const Pose& handle, const Twist& handle_twist, Mat6& K, Mat6& B) const;
  Mat6 mass_matrix() const;  ///< at the current pose, world axes, about the origin
  /// Of its motion now [J].
  double kinetic_energy() const;
  double potential_energy(const Pose& handle) const;  ///< of the coupling to a handle, and of the weight [J]
  double coupling_energy(const Pose& handle) const;   ///< of the coupling's springs to a handle [J]

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Names and orders of the tool's own tick schemes.
struct ToolIntegratorInfo {
  std::string name, summary;  ///< as scenes call it, and one line about it
  int order;                  ///< theoretical order in the tick's length
};
/// All of them, in the order of `palpate list tool-integrators`.
const std::vector<ToolIntegratorInfo>& tool_integrators();

/// Whether this was built with Simbody: without it there are no tools and no bones on joints.
bool available();
/// Version of the Simbody that this was built with; empty without it.
std::string simbody_version();

}  // namespace palpate::tool
