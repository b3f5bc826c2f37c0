#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "distance/gap.h"
#include "palpate/loop/world.h"

/// Exact gaps between the objects of a scene at its start, by their geometry alone.
namespace palpate::loop {

/// Object of a scene at its initial position, for exact distances.
class PlacedObject {
 public:
  /// Returns the surface of a body that contact uses. @throws Error where it is not closed
  static PlacedObject body(const Body& body);
  /// Returns a tool at the position of its spec. @param folder  of the scene, for its mesh
  static PlacedObject tool(const std::string& name, const ToolSpec& spec, const std::string& folder);
  static PlacedObject obstacle(const ObstacleSpec& spec);  ///< Returns a fixed shape.

  const std::string& name() const { return name_; }
  bool is_obstacle() const { return static_cast<bool>(nearest_); }
  void shift(const Vec3& by);  ///< Moves a body or a tool [m].
  /// Returns the corners of the bounding box; empty for an unbounded obstacle.
  std::optional<Eigen::AlignedBox3d> bounds() const;

  /// Returns the gap of two objects, at most one of them an obstacle: exact for bodies and tools, and for
  /// balls and planes; for other obstacles that of their triangulated surfaces.
  friend distance::Gap gap_between(const PlacedObject& first, const PlacedObject& second);

 private:
  std::string name_;
  Pose pose_;                                               ///< Pose of the surface, or centre of the ball.
  std::optional<distance::RigidSurface> surface_;           ///< Absent for balls and unbounded obstacles.
  double radius_ = 0.0;                                     ///< Radius of a ball [m]; 0: no ball.
  std::function<contact::Nearest(const Vec3& x)> nearest_;  ///< Exact shape of an obstacle.
};
distance::Gap gap_between(const PlacedObject& first, const PlacedObject& second);

/// Returns how far the first object has to move along a unit vector until the overlap with the second ends
/// [m], to within a micrometre; it stays where it is.
double distance_out(PlacedObject& first, const PlacedObject& second, const Vec3& direction);

/// Two objects of a scene at its start; the first is a tool where one of them is.
struct Clearance {
  std::string first, second;  ///< Names.
  distance::Gap gap;
  bool in_contact = false;  ///< Whether a [[contact]] lists the pair.
  /// Displacement of the first object that separates the two, in the direction in which its deepest point
  /// comes out; zero where they are separate [m].
  Vec3 way_out_m = Vec3::Zero();
};

/// Returns all pairs of tools, bodies and obstacles, except pairs of two obstacles. Tools are placed as in
/// the description of the World, which assemble() has completed.
std::vector<Clearance> clearances(const World& world);

/// Returns the pair of a [[contact]], by its number; empty for self-contact.
std::optional<Clearance> clearance_of(const World& world, std::size_t contact);

/// Returns a direction for messages, "(0, 0.6, 0.8)".
std::string direction_text(const Vec3& direction);

/// Returns whether a tool starts with its centre inside the other side of a [[contact]], by its number, or a
/// body or a tool with a surface lies in another as a whole. Contact has no overlapping points there. Costs
/// one pass over the faces, without a tree.
bool starts_enclosed(const World& world, std::size_t contact);

/// Returns an overlap as text, without the end of the sentence: `"tool" starts 12 mm inside "head"; move
/// "tool" by 13.5 mm along (0, 0, 1)`.
std::string overlap_text(const Clearance& clearance);

}  // namespace palpate::loop
