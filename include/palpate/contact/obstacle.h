#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "palpate/contact/contact_force.h"
#include "palpate/contact/side.h"
#include "palpate/contact/spec.h"
#include "palpate/core/registry.h"
#include "palpate/mesh/mesh.h"

/// Rigid shapes with exact gaps, fixed in the world.  Each is one file in src/contact/obstacles: its gap, its
/// keys, its picture.  Another one is its file there, its line in obstacle_registry() and in CMakeLists.txt;
/// tests/contact/obstacle_conformance_test.cpp runs over all of them.
namespace palpate::contact {

/// The point of a shape's surface nearest to a point x.
struct Nearest {
  double gap;   ///< signed distance from the surface, negative inside [m]
  Vec3 normal;  ///< outward, unit: the gradient of the gap; world axes
  /// radius of curvature there of a sphere or a cylinder, whose centre lies that far within [m]; 0 of faces
  /// and edges, which rotate with the shape
  double radius = 0.0;
};

/// How thick a body is and how curved on average, which the number of contact points is chosen by.
struct CharacteristicLengths {
  double width;  ///< least way through it [m]; infinite of a half-space
  /// A / integral of H dA with the mean curvature H: the radius of a ball; infinite where flat and hollow
  /// parts outweigh the round ones [m]
  double radius;
  /// Mean curvature that linear gaps do not know of: 0 of planes and boxes, where they are exact, and of
  /// spheres, whose curvature is known [1/m]
  double bend;
};

/// What a picture is of: its middle and its size.
struct View {
  Vec3 centre = Vec3::Zero();  ///< what the picture looks at [m]
  double extent = 1.0;         ///< [m]
};

/// A surface for pictures.
struct ObstaclePicture {
  TriMesh surface;  ///< in the world
  /// of a horizontal surface without an end that looks up: its height, for a picture that can draw a ground
  std::optional<double> ground_m = {};
};

/// Makes the contact of one side with a shape that `motion` carries.  Samples beyond `candidate_gap` [m] are
/// left out; `look_ahead` [s] is the time to the next query.
using MakeObstacleSource = std::unique_ptr<SampleSource> (*)(ContactSide side, int frame,
                                                             std::shared_ptr<MovingFrame> motion,
                                                             const Settings& shape, double candidate_gap,
                                                             double look_ahead);
/// One obstacle.  `shape` is complete: every key of the entry has a value (complete() of core/keys.h).
struct ObstacleEntry {
  std::string name, summary;       ///< as a scene's `obstacle.type`; one line about it
  std::vector<PartKey> keys;       ///< what its shape is made of
  MakeObstacleSource make_source;  ///< its contact
  CharacteristicLengths (*lengths)(const Settings& shape);  ///< thickness and roundness of the shape
  /// the surface's point nearest to x, in world axes, where the shape does not move
  Nearest (*nearest)(const Settings& shape, const Vec3& x);
  /// its surface, for pictures
  ObstaclePicture (*picture)(const Settings& shape, const View& view);
  /// its closed surface in the world, no edge of a curved part longer than `spacing` [m], corners on the
  /// shape; null of shapes without an end, whose own points never count
  TriMesh (*surface)(const Settings& shape, double spacing) = nullptr;
};
/// All of them, in the order of `palpate list obstacles`.
const std::vector<ObstacleEntry>& obstacle_registry();

/// The entry that the spec names.  @throws Error for an unknown type
const ObstacleEntry& obstacle_entry(const ObstacleSpec& spec);
/// Its shape with defaults.  @throws Error for unknown, missing and bad keys
Settings obstacle_shape(const ObstacleSpec& spec);

}  // namespace palpate::contact
