#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "palpate/contact/sample_source.h"
#include "palpate/contact/side.h"
#include "palpate/contact/spec.h"
#include "palpate/core/registry.h"
#include "palpate/mesh/mesh.h"

/// Rigid shapes with exact gaps. As obstacles they are fixed in the world; a tool reuses the sphere. Each is
/// implemented in one file of src/contact/obstacles: its gap, its keys, its picture. A new obstacle needs
/// that file, its name in PALPATE_OBSTACLES (obstacle.cpp) and its file name in CONTACT_OBSTACLES
/// (CMakeLists.txt); tests/contact/obstacle_conformance_test.cpp runs over all obstacles.
namespace palpate::contact {

/// Point of a shape's surface nearest to a point x.
struct Nearest {
  double gap;   ///< Signed distance from the surface, negative inside [m].
  Vec3 normal;  ///< Outward unit normal: the gradient of the gap; world axes.
  /// Radius of curvature at the point, for a sphere or a cylinder, whose centre lies at that distance inside
  /// the surface [m]; 0 for faces and edges, which rotate with the shape.
  double radius = 0.0;
};

/// Thickness and mean curvature of a body, from which the number of contact points is chosen.
struct CharacteristicLengths {
  double width;  ///< Smallest thickness [m]; infinite for a half-space.
  /// A / integral of H dA with the mean curvature H [m]: for a ball its radius; infinite where flat and
  /// concave parts outweigh the convex ones.
  double radius;
  /// Mean curvature that linear gaps do not represent [1/m]: 0 for planes and boxes, where linear gaps are
  /// exact, and for spheres, whose curvature is known.
  double bend;
};

/// Centre and size of the region that a picture shows.
struct View {
  Vec3 centre = Vec3::Zero();  ///< Centre of the view [m].
  double extent = 1.0;         ///< Size of the view [m].
};

/// Surface of an obstacle for pictures.
struct ObstaclePicture {
  TriMesh surface;  ///< Surface in world coordinates.
  /// Height of an unbounded horizontal surface that faces upwards [m], for a picture that can draw a ground
  /// plane; otherwise empty.
  std::optional<double> ground_m = {};
};

/// Makes the contact of one side with a shape that `motion` carries. Samples with a gap beyond
/// `candidate_gap` [m] are omitted; `look_ahead` [s] is the time to the next query.
using MakeObstacleSource = std::unique_ptr<SampleSource> (*)(ContactSide side, int frame,
                                                             std::shared_ptr<MovingFrame> motion,
                                                             const Settings& shape, double candidate_gap,
                                                             double look_ahead);
/// Registry entry of one obstacle type. `shape` is complete: every key of the entry has a value
/// (complete() of core/keys.h).
struct ObstacleEntry {
  std::string name, summary;       ///< Name as in a scene's `obstacle.type`; one-line summary.
  std::vector<PartKey> keys;       ///< Keys that define the shape.
  MakeObstacleSource make_source;  ///< Makes the contact source.
  /// Computes thickness and mean radius of the shape.
  CharacteristicLengths (*lengths)(const Settings& shape);
  /// Computes the point of the surface nearest to x, in world axes, for the shape at rest.
  Nearest (*nearest)(const Settings& shape, const Vec3& x);
  /// Makes the surface for pictures.
  ObstaclePicture (*picture)(const Settings& shape, const View& view);
  /// Makes a closed triangulated surface in world coordinates, with no edge of a curved part longer than
  /// `spacing` [m] and all vertices on the shape; null for unbounded shapes, which have no contact points.
  TriMesh (*surface)(const Settings& shape, double spacing) = nullptr;
};
/// Returns all obstacle types, in the order of `palpate list obstacles`.
const std::vector<ObstacleEntry>& obstacle_registry();

/// Returns the entry of the type that the spec specifies. @throws Error for an unknown type
const ObstacleEntry& obstacle_entry(const ObstacleSpec& spec);
/// Returns the shape completed by defaults. @throws Error for unknown, missing and invalid keys
Settings obstacle_shape(const ObstacleSpec& spec);

}  // namespace palpate::contact
