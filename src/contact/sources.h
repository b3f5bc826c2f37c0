#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string_view>

#include "palpate/contact/contact_force.h"
#include "palpate/contact/obstacle.h"
#include "palpate/contact/side.h"
#include "palpate/mesh/mesh.h"
#include "proxy/proxy_set.h"

namespace palpate::contact {

/// Makes the contact of a soft or rigid surface, or of a ball, with an exact shape in a frame.
///
/// For a surface each vertex is one sample: gap = signed distance, normal = outward normal of the shape at
/// the closest point, area = area vector of the vertex projected on that normal (one third of each adjacent
/// triangle, deformed). Vertices that face away from the shape, where pressure would pull, make no sample.
/// For a ball the samples are rings around the shape's normal at the point nearest to the centre
/// (src/contact/ball_source.h): force = k x overlap volume, without moment about the centre unless there is
/// friction.
/// @param candidate_gap  vertices nearer than this are kept as candidates [m]; 0: the surface's mean edge at
///   the first query, for a ball an eighth of its radius
/// @param look_ahead     time to the next query [s]: vertices that come nearer than candidate_gap in this
///   time, at their present speed, are kept as well. Without it a fast body penetrates undetected and is
///   thrown back with spurious energy.
std::unique_ptr<SampleSource> make_plane_source(ContactSide side, int frame,
                                                std::shared_ptr<MovingFrame> motion, const Vec3& point,
                                                const Vec3& normal, double candidate_gap,
                                                double look_ahead = 0.0);
std::unique_ptr<SampleSource> make_sphere_source(ContactSide side, int frame,
                                                 std::shared_ptr<MovingFrame> motion, const Vec3& centre,
                                                 double radius, double candidate_gap,
                                                 double look_ahead = 0.0);
/// Makes the contact with a box of the given edges, or with a cylinder along the z axis of `pose` between
/// flat ends; both are centred at `pose` in the frame. Outside the shape the normal points from the nearest
/// point of the surface (at edges and corners a direction between the faces' normals); inside, the nearest
/// face is used.
std::unique_ptr<SampleSource> make_box_source(ContactSide side, int frame,
                                              std::shared_ptr<MovingFrame> motion, const Pose& pose,
                                              const Vec3& size, double candidate_gap,
                                              double look_ahead = 0.0);
std::unique_ptr<SampleSource> make_cylinder_source(ContactSide side, int frame,
                                                   std::shared_ptr<MovingFrame> motion, const Pose& pose,
                                                   double radius, double length, double candidate_gap,
                                                   double look_ahead = 0.0);

/// Options of a contact in image space.
struct ImageOptions {
  int pixels = 64;             ///< Longer edge of the image [pixels].
  double candidate_gap = 0.0;  ///< Candidate gap [m]; 0: a quarter of the soft surface's mean edge.
  /// Time to the next query [s]: the candidate gap of a region is at least the distance by which its surfaces
  /// may approach each other in this time at their present velocities.
  double look_ahead = 0.0;
  /// Shift of the pixel grid, in pixels, in [0, 1): for studies of the discretisation error.
  double shift_u = 0.0;
  double shift_v = 0.0;
};

/// Makes an image-space contact (Galoppo et al. 2007, docs/theory/image-contact.md) with one region whose
/// plane is found by libccd. OpenGL rasterises both surfaces along its normal. Each vertex of the soft skins
/// that the image shows yields one sample for a third of its triangles' projected area (half of that if both
/// bodies are soft); the gap to the triangle that the image shows opposite is computed in double precision.
/// The first query opens the GL context.
/// @throws Error (the first query) where no EGL device can be opened, with the package that provides it
std::unique_ptr<SampleSource> make_image_source(NodeSurface surface, TriMesh rigid, int frame,
                                                std::shared_ptr<MovingFrame> motion,
                                                const ImageOptions& options);

/// Makes an image-space contact with convex proxies of both sides (docs/theory/image-contact.md). Only skin
/// that may be near the other side is evaluated, in regions with separate planes and images, so that bodies
/// that are not a height field as a whole are seen from all sides on which they are touched. Each face of the
/// first skin belongs to at most one region.
/// @param proxies  proxies of `surface`, a skin, with the same faces; may be shared by several sources
/// @param proxies_rigid  proxies of `rigid`, in its frame, from proxy::rigid_proxies; may be shared by
///   several sources
std::unique_ptr<SampleSource> make_image_source(NodeSurface surface, std::shared_ptr<proxy::ProxySet> proxies,
                                                TriMesh rigid, std::shared_ptr<proxy::ProxySet> proxies_rigid,
                                                int frame, std::shared_ptr<MovingFrame> motion,
                                                const ImageOptions& options);

/// Makes an image-space contact of two soft bodies: both points of a sample are interpolated from nodes, so
/// the force acts on both bodies, equal and opposite, and the tangent couples them. The pattern has blocks
/// between the nodes of the two bodies where samples were found, and grows with the contact
/// (pattern_version). Side a of the samples is the body whose block is older, in whichever order they are
/// given: the pixel grid and its normal are bitwise the same.
std::unique_ptr<SampleSource> make_image_source(NodeSurface a, NodeSurface b, const ImageOptions& options);
std::unique_ptr<SampleSource> make_image_source(NodeSurface a, std::shared_ptr<proxy::ProxySet> proxies_a,
                                                NodeSurface b, std::shared_ptr<proxy::ProxySet> proxies_b,
                                                const ImageOptions& options);

/// Returns the characteristic lengths of a closed surface.
CharacteristicLengths lengths_of(const TriMesh& closed);
/// Returns the spacing of a body's contact points against another body: the longest edge of the triangles
/// between them [m] (src/contact/material_points.cpp).
/// @param wanted_error  target relative error of the force, for a contact whose depth is an eighth of its
///   radius
double point_spacing(const CharacteristicLengths& own, const CharacteristicLengths& other,
                     double wanted_error);
/// Returns material points of a soft surface, for contact with an exact shape.
/// @param rest  vertices of the surface at rest [m]  @param body  tetrahedral mesh at rest; used for embedded
///   skins only
/// @param spacing  from point_spacing() [m]
/// @throws Error where the surface is not closed, or a face of it has no area
MaterialPoints material_points(const NodeSurface& surface, const Points& rest, const TetMesh& body,
                               double spacing);
/// Returns material points of a rigid surface. Throws like the overload for soft surfaces.
MaterialPoints material_points(const FrameSurface& surface, double spacing);

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

/// Returns the spacing of contact points on the surface of a shape against a body, as point_spacing() [m].
double shape_spacing(const CharacteristicLengths& shape, const CharacteristicLengths& body,
                     double wanted_error);
/// Returns a triangulated sphere about the origin: see ObstacleEntry::surface.
TriMesh sphere_surface(double radius, double spacing);

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

/// Combines two sources of one pair with half of the weight each. @pre both have the same side first
std::unique_ptr<SampleSource> make_half_and_half(std::unique_ptr<SampleSource> first,
                                                 std::unique_ptr<SampleSource> second);

}  // namespace palpate::contact
