#pragma once
#include <vector>

#include "palpate/contact/contact_force.h"
#include "palpate/dynamics/rigid_body.h"
#include "palpate/dynamics/system.h"

namespace palpate::loop {

/// Bodies and one tool that touches them, at an exchange: everything that the linearisation of its contact
/// reads.
struct CoupledTool {
  dynamics::System& system;
  const dynamics::State& state;  ///< At the time of the exchange.
  contact::ContactForce& contact;
  int frame;                     ///< The tool's frame in `contact`.
  dynamics::RigidMotion motion;  ///< Motion of the tool at the State's time.
  /// Other tools that touch bodies. They continue with their twists.
  struct Other {
    int frame;
    Twist twist;
  };
  std::vector<Other> others = {};
};

/// Returns (angular, linear).
inline Vec6 stacked(const Twist& twist) {
  Vec6 out;
  out << twist.angular, twist.linear;
  return out;
}

}  // namespace palpate::loop
