#pragma once
#include <memory>
#include <variant>
#include <vector>

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

/// Material points of a surface, and the triangles between them over which a gap is linear.
struct MaterialPoints {
  std::vector<SurfacePoint> at;           ///< of nodes, counted inside the block; or of a frame
  Faces triangles;                        ///< their corners
  VecX area;                              ///< of each triangle, at rest [m^2]
  VecX edges2;                            ///< of each: sum of its edges' squares, at rest [m^2]
  int block_id = -1;                      ///< the node block that carries them; -1: a frame does
  std::shared_ptr<MovingFrame> motion{};  ///< moves the frame
};

/// A ball that a frame carries: its surface is exact.
struct FrameBall {
  double radius = 0.0;                    ///< [m]
  Vec3 centre = Vec3::Zero();             ///< in the frame
  int frame = -1;                         ///< index for SurfacePoint::frame
  std::shared_ptr<MovingFrame> motion{};  ///< moves the frame
  /// whether its own surface counts, as material points do, or the overlap's cross-section
  bool by_surface = false;
};

/// What one side of a contact may be.
using ContactSide = std::variant<NodeSurface, FrameSurface, MaterialPoints, FrameBall>;

}  // namespace palpate::contact
