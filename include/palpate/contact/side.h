#pragma once
#include <memory>
#include <variant>

#include "palpate/contact/contact_force.h"
#include "palpate/mesh/mesh.h"

/// What may touch an exact shape: each side of a contact is soft or rigid.
namespace palpate::contact {

/// A closed surface that a frame carries.
struct FrameSurface {
  TriMesh mesh;                           ///< in the frame's axes, outward
  int frame = -1;                         ///< index for SurfacePoint::frame
  std::shared_ptr<MovingFrame> motion{};  ///< moves the frame
};

/// A ball that a frame carries: its surface is exact.
struct FrameBall {
  double radius = 0.0;                    ///< [m]
  Vec3 centre = Vec3::Zero();             ///< in the frame
  int frame = -1;                         ///< index for SurfacePoint::frame
  std::shared_ptr<MovingFrame> motion{};  ///< moves the frame
};

/// What one side of a contact may be.
using ContactSide = std::variant<NodeSurface, FrameSurface, FrameBall>;

}  // namespace palpate::contact
