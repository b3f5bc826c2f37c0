#pragma once
#include <memory>
#include <variant>
#include <vector>

#include "palpate/contact/frame.h"
#include "palpate/contact/sample.h"
#include "palpate/mesh/embedding.h"
#include "palpate/mesh/mesh.h"

/// Sides of a contact with an exact shape; each is soft or rigid.
namespace palpate::contact {

/// Surface carried by nodes of the State. Its vertices are either nodes (vertex i is node
/// `node_of_vertex[i]`, counted within the block) or points of an embedded skin (vertex i is interpolated
/// from the nodes of the tetrahedron `tets.col(embedding.tet[i])` with four weights; docs/theory/proxies.md).
struct NodeSurface {
  int block_id = -1;                ///< Node block that carries the surface.
  std::vector<int> node_of_vertex;  ///< Node of each vertex; empty for a skin.
  Faces faces;                      ///< Vertex indices per face, oriented outwards.
  mesh::Embedding embedding{};      ///< Skin only: tetrahedron and weights per vertex.
  Tets tets{};                      ///< Skin only: the body's tetrahedra, nodes counted within the block.
};

/// Closed surface carried by a frame.
struct FrameSurface {
  TriMesh mesh;                           ///< Surface in the frame's axes, oriented outwards.
  int frame = -1;                         ///< Index for SurfacePoint::frame.
  std::shared_ptr<MovingFrame> motion{};  ///< Motion of the frame.
};

/// Material points of a surface, and the triangles between them over which the gap is linear.
struct MaterialPoints {
  std::vector<SurfacePoint> at;  ///< Points: weighted nodes, counted within the block, or points of a frame.
  Faces triangles;               ///< Corners of the triangles, as indices of points.
  VecX area;                     ///< Area per triangle at rest [m^2].
  VecX edges2;                   ///< Sum of squared edge lengths per triangle at rest [m^2].
  int block_id = -1;             ///< Node block that carries them; -1: a frame does.
  std::shared_ptr<MovingFrame> motion{};  ///< Motion of the frame.
};

/// Ball carried by a frame; its surface is exact.
struct FrameBall {
  double radius = 0.0;                    ///< Radius [m].
  Vec3 centre = Vec3::Zero();             ///< Centre in the frame's axes [m].
  int frame = -1;                         ///< Index for SurfacePoint::frame.
  std::shared_ptr<MovingFrame> motion{};  ///< Motion of the frame.
  /// True: the force is integrated over the ball's surface, as with material points. False: over the
  /// cross-section of the overlap.
  bool by_surface = false;
};

/// One side of a contact.
using ContactSide = std::variant<NodeSurface, FrameSurface, MaterialPoints, FrameBall>;

}  // namespace palpate::contact
