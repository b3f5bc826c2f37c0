#pragma once
#include <functional>
#include <memory>
#include <optional>

#include "palpate/contact/obstacle.h"
#include "palpate/contact/sample_source.h"
#include "palpate/contact/side.h"

namespace palpate::contact {

/// Options of a contact by nearest points.
struct DistanceOptions {
  double quadrature_error = 1e-2;  ///< Target relative error of the force, as in point_spacing().
  /// Points nearer than this are kept as candidates [m]; 0: the mean spacing of the points.
  double candidate_gap = 0.0;
  double look_ahead = 0.0;  ///< Time to the next query [s]: points that may touch within it are kept too.
  double spacing = 0.0;  ///< Spacing of both sides' points, for studies [m]; 0: chosen from quadrature_error.
};

/// Makes the contact of two soft surfaces by nearest points (src/contact/distance_source.cpp): material
/// points of both skins, fixed at assembly, each paired with the nearest point of the other skin. With a
/// pressure k |gap| the forces derive from an energy. They are continuous wherever nearest points are, and
/// the two forces of each pair are opposite and act along one line.
/// @param rest_a, rest_b  vertices of the surfaces at rest [m]
/// @throws Error where a surface is not closed, or a face of it has no area
std::unique_ptr<SampleSource> make_distance_source(NodeSurface a, const Points& rest_a, NodeSurface b,
                                                   const Points& rest_b, const DistanceOptions& options);
/// Makes the contact of a soft surface and a rigid one by nearest points.
/// @param rest  vertices of the soft surface at rest [m]
std::unique_ptr<SampleSource> make_distance_source(NodeSurface surface, const Points& rest,
                                                   const FrameSurface& other, const DistanceOptions& options);
/// Makes the contact of two rigid surfaces by nearest points.
std::unique_ptr<SampleSource> make_distance_source(const FrameSurface& a, const FrameSurface& b,
                                                   const DistanceOptions& options);

/// Returns the largest overlap that self-contact of a body detects: a quarter of its mean radius [m].
inline double own_contact_depth(const CharacteristicLengths& body) { return 0.25 * body.radius; }
/// Makes self-contact of a soft body: material points of its skin, each paired with the nearest point among
/// those that are farther from it than half of the body's mean radius, along the skin and through tissue.
/// Overlaps that are due to the body's thickness are not contact (SelfContactFilter), and there is none at
/// rest.
/// @param surface  skin embedded in tetrahedra  @param rest  vertices of the skin at rest [m]
/// @param rest_nodes  nodes of the body at rest [m]
/// @throws Error where the surface is not closed, or a face of it has no area
std::unique_ptr<SampleSource> make_own_distance_source(NodeSurface surface, const Points& rest,
                                                       const Points& rest_nodes,
                                                       const DistanceOptions& options);

/// Parameters of contact points on the surface of an exact shape.
struct ShapePoints {
  FrameSurface surface;  ///< Triangulated surface with its vertices on the shape.
  double spacing = 0.0;  ///< Longest edge of the triangles after subdivision [m].
  /// Returns the shape's point nearest to x, in the frame's axes.
  std::function<Vec3(const Vec3& x)> onto = {};
  std::optional<Vec3> centre = {};  ///< Centre in the frame's axes, for a ball only.
};
/// Makes the contact of a soft surface with an exact shape by nearest points, with contact points on the
/// shape's surface only. It is the half of the two-sided contact that the source of the exact shape, which
/// uses the other surface's points, does not contain.
/// @param rest  vertices of the soft surface at rest [m]
std::unique_ptr<SampleSource> make_distance_source(NodeSurface surface, const Points& rest,
                                                   const ShapePoints& shape, const DistanceOptions& options);
/// Makes the contact of a rigid surface with an exact shape by nearest points, with contact points on the
/// shape's surface only.
std::unique_ptr<SampleSource> make_distance_source(const FrameSurface& surface, const ShapePoints& shape,
                                                   const DistanceOptions& options);

}  // namespace palpate::contact
