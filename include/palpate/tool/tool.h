#pragma once
#include <memory>
#include <string>

#include "palpate/core/pose.h"
#include "palpate/core/registry.h"
#include "palpate/dynamics/exchange.h"
#include "palpate/dynamics/stepper.h"
#include "palpate/tool/spec.h"

namespace palpate::tool {

/// The handle's motion over one tick, as the coupling sees it: pose and twist at the tick's end (implicit
/// schemes) and start.
struct HandleMotion {
  Pose pose0, pose1;
  Twist twist0, twist1;
};

/// A Simbody MobilizedBody::Free under a 6-DoF virtual coupling and a linearised contact
/// (docs/design.md, 4.5).  The Simbody System stays behind the pimpl.
class Tool {
 public:
  Tool(const ToolSpec& spec, const Vec3& gravity);
  ~Tool();
  Tool(Tool&&) noexcept;

  double time() const;
  Pose pose() const;
  Twist twist() const;
  void set_state(double t, const Pose& pose, const Twist& twist);

  /// One tick of `h` seconds with the contact linear about its record, by the scheme that the spec names.
  dynamics::StepResult advance(double h, const HandleMotion& handle,
                               const dynamics::LinearisedContact& contact);

  /// Wrench that the coupling exerts on the tool about its origin, for a handle pose (before any limit).
  Wrench coupling_wrench(const Pose& handle, const Twist& handle_twist) const;
  /// The coupling wrench on the hand: force opposite, moment about the handle's origin.
  Wrench wrench_on_hand(const Pose& handle, const Twist& handle_twist) const;

  /// K = -dF/dx and B = -dF/dv of the coupling at the current pose (6x6, angular first): added to the tool's
  /// rows by `condensed` linearisations and monolithic coupling.
  void coupling_tangent(const Pose& handle, const Twist& handle_twist, Mat6& K, Mat6& B) const;
  Mat6 mass_matrix() const;  ///< at the current pose, world axes, about the origin
  double kinetic_energy() const;
  double potential_energy(const Pose& handle) const;  ///< of the coupling to a handle, and of the weight [J]

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Names and orders of the tool's own tick schemes.
struct ToolIntegratorInfo {
  std::string name, summary;
  int order;
};
const std::vector<ToolIntegratorInfo>& tool_integrators();

/// Whether this was built with Simbody: without it there are no tools and no bones on joints.
bool available();
/// Version of the Simbody that this was built with; empty without it.
std::string simbody_version();

}  // namespace palpate::tool
