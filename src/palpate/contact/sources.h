#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string_view>

#include "palpate/contact/contact_force.h"
#include "palpate/contact/obstacle.h"
#include "palpate/contact/side.h"
#include "palpate/mesh/mesh.h"
#include "palpate/proxy/proxy_set.h"

namespace palpate::contact {

/// A soft or rigid surface, or a ball, against an exact shape in a frame.
///
/// Of a surface the vertices: one sample each, gap = signed distance,
/// normal = the shape's outward normal at the closest point, area = the vertex's area vector projected on
/// that normal (one third of each adjacent triangle, deformed).
/// Vertices that face away from the shape (where pressure would pull) make no sample.
/// Of a ball the overlap along the shape's normal at the point nearest to the centre, in rings around it
/// (src/contact/ball_source.h): force = k x overlap volume, and no moment about the centre without friction.
/// @param candidate_gap  vertices nearer than this are kept as candidates [m]; 0: the surface's mean edge
///   at the first query, of a ball an eighth of its radius
/// @param look_ahead     [s] to the next query: vertices that come nearer than candidate_gap in this time,
///   at their present speed, are kept as well.
///                       Without it a fast body passes through unseen and is thrown back with energy from
///                       nowhere.
std::unique_ptr<SampleSource> make_plane_source(ContactSide side, int frame,
                                                std::shared_ptr<MovingFrame> motion, const Vec3& point,
                                                const Vec3& normal, double candidate_gap,
                                                double look_ahead = 0.0);
std::unique_ptr<SampleSource> make_sphere_source(ContactSide side, int frame,
                                                 std::shared_ptr<MovingFrame> motion, const Vec3& centre,
                                                 double radius, double candidate_gap,
                                                 double look_ahead = 0.0);
/// A box with the given edges, and a cylinder along its own z between flat ends; both centred at `pose`
/// in the frame. Outside, the nearest point of the surface and the way from it (at edges and corners a
/// direction between the faces'); inside, the nearest face.
std::unique_ptr<SampleSource> make_box_source(ContactSide side, int frame,
                                              std::shared_ptr<MovingFrame> motion, const Pose& pose,
                                              const Vec3& size, double candidate_gap,
                                              double look_ahead = 0.0);
std::unique_ptr<SampleSource> make_cylinder_source(ContactSide side, int frame,
                                                   std::shared_ptr<MovingFrame> motion, const Pose& pose,
                                                   double radius, double length, double candidate_gap,
                                                   double look_ahead = 0.0);

/// How a contact in image space is looked at.
struct ImageOptions {
  int pixels = 64;             ///< longer edge of the image
  double candidate_gap = 0.0;  ///< [m]; 0: a quarter of the soft surface's mean edge
  /// [s] to the next query: a region's candidate gap is at least what its surfaces may come nearer in this
  /// time at their present velocities
  double look_ahead = 0.0;
  /// the pixel grid moved by this part of a pixel, in [0, 1): for studies of the pixels' error
  double shift_u = 0.0;
  double shift_v = 0.0;
};

/// Image space (Galoppo et al. 2007, docs/design.md 4.3): one region with its plane from libccd, both
/// surfaces rasterised along its normal by OpenGL, a sample at each vertex of the soft skins that the image
/// shows, for a third of its triangles' projected area (of two soft bodies for half of that); the gap in
/// double to the triangle that the image shows opposite.  The first query opens the GL context.
/// @throws Error (the first query) where no EGL device can be opened, with the package that brings it
std::unique_ptr<SampleSource> make_image_source(NodeSurface surface, TriMesh rigid, int frame,
                                                std::shared_ptr<MovingFrame> motion,
                                                const ImageOptions& options);

/// Image space with convex proxies of both sides (docs/design.md 4.2, 4.3): only skin that may be near is
/// looked at, in regions that have each its own plane and image, so that bodies which are no height field as
/// a whole are seen from all sides that they are touched on.  Each face of the first skin is in one region
/// at most.
/// @param proxies  of `surface`, a skin: the set's faces are the surface's; it may serve several sources
/// @param proxies_rigid  of `rigid`, in its frame, as proxy::rigid_proxies makes them; it may serve several
///   sources
std::unique_ptr<SampleSource> make_image_source(NodeSurface surface, std::shared_ptr<proxy::ProxySet> proxies,
                                                TriMesh rigid, std::shared_ptr<proxy::ProxySet> proxies_rigid,
                                                int frame, std::shared_ptr<MovingFrame> motion,
                                                const ImageOptions& options);

/// Two soft bodies: both points of a sample hang on nodes, so its force reaches both bodies, equal and
/// opposite, and its tangent couples them.  The pattern has blocks between the two bodies' nodes where
/// samples were found, and grows with the contact (pattern_version).  Side a of the samples is the body
/// whose block is older, whichever is named first: the pixel grid and its normal are the same, to the bit.
std::unique_ptr<SampleSource> make_image_source(NodeSurface a, NodeSurface b, const ImageOptions& options);
std::unique_ptr<SampleSource> make_image_source(NodeSurface a, std::shared_ptr<proxy::ProxySet> proxies_a,
                                                NodeSurface b, std::shared_ptr<proxy::ProxySet> proxies_b,
                                                const ImageOptions& options);

/// Returns those of a closed surface.
CharacteristicLengths lengths_of(const TriMesh& closed);
/// Returns how far apart a body's contact points stand against another: the longest edge of the triangles
/// that they are the corners of [m] (src/contact/material_points.cpp).
/// @param wanted_error  of the force of a contact an eighth as deep as its radius [-]
double point_spacing(const CharacteristicLengths& own, const CharacteristicLengths& other,
                     double wanted_error);
/// Returns material points of a soft surface, against an exact shape.
/// @param rest  its vertices at rest [m]  @param body  at rest: what a skin hangs on, else unused
/// @param spacing  as point_spacing() has it [m]
/// @throws Error where the surface is not closed, or a face of it has no area
MaterialPoints material_points(const NodeSurface& surface, const Points& rest, const TetMesh& body,
                               double spacing);
/// Returns those of a rigid surface.  Throws as above.
MaterialPoints material_points(const FrameSurface& surface, double spacing);

struct DistanceOptions {
  double quadrature_error = 1e-2;  ///< wanted, as point_spacing() has it
  /// Points nearer than this are kept as candidates [m]; 0: as far as they stand from each other, in the
  /// mean.
  double candidate_gap = 0.0;
  double look_ahead = 0.0;  ///< [s] to the next query: points that may come near until then are kept, too
  double spacing = 0.0;     ///< of both sides' points, for studies of it; 0: by the wanted error [m]
};

/// Nearest points (src/contact/distance_source.cpp): material points of both skins, fixed at assembly, each
/// with the nearest point of the other one.  With a pressure k |gap| their forces are those of an energy,
/// continuous wherever nearest points are, and of each point on one line with its opposite.
/// @param rest_a, rest_b  vertices of the surfaces at rest [m]
/// @throws Error where a surface is not closed, or a face of it has no area
std::unique_ptr<SampleSource> make_distance_source(NodeSurface a, const Points& rest_a, NodeSurface b,
                                                   const Points& rest_b, const DistanceOptions& options);
/// A soft surface and a rigid one.
/// @param rest  vertices of the soft one at rest [m]
std::unique_ptr<SampleSource> make_distance_source(NodeSurface surface, const Points& rest,
                                                   const FrameSurface& other, const DistanceOptions& options);
/// Two rigid surfaces.
std::unique_ptr<SampleSource> make_distance_source(const FrameSurface& a, const FrameSurface& b,
                                                   const DistanceOptions& options);

/// Returns the depth up to which overlaps of a body with itself are found: a quarter of its mean radius [m].
inline double own_contact_depth(const CharacteristicLengths& body) { return 0.25 * body.radius; }
/// One soft body against itself: material points of its skin, each with the nearest point of what lies
/// farther than half of the body's mean radius from it, along the skin and through tissue.  What overlaps
/// because the body is thick there is no contact (SelfContactFilter), at rest nothing is.
/// @param surface  a skin in tetrahedra  @param rest  its vertices  @param rest_nodes  the body's nodes, at
///   rest [m]
/// @throws Error where the surface is not closed, or a face of it has no area
std::unique_ptr<SampleSource> make_own_distance_source(NodeSurface surface, const Points& rest,
                                                       const Points& rest_nodes,
                                                       const DistanceOptions& options);

/// Returns the spacing of points of a shape's own surface against a body, as point_spacing() [m].
double shape_spacing(const CharacteristicLengths& shape, const CharacteristicLengths& body,
                     double wanted_error);
/// A sphere's surface in triangles, about its centre: see ObstacleEntry::surface.
TriMesh sphere_surface(double radius, double spacing);

/// Points of a shape's own surface.
struct ShapePoints {
  FrameSurface surface;                          ///< in triangles, their corners on the shape
  double spacing = 0.0;                          ///< longest edge of the triangles after they are cut [m]
  std::function<Vec3(const Vec3& x)> onto = {};  ///< the shape's point nearest to x, in the frame's axes
  std::optional<Vec3> centre = {};               ///< of a ball, in the frame; else none
};
/// Points of a shape's surface alone against another surface, as make_distance_source(): the half that an
/// exact shape's own source, over the other one's points, does not see.
/// @param rest  vertices of the soft surface at rest [m]
std::unique_ptr<SampleSource> make_distance_source(NodeSurface surface, const Points& rest,
                                                   const ShapePoints& shape, const DistanceOptions& options);
/// The same against a rigid surface.
std::unique_ptr<SampleSource> make_distance_source(const FrameSurface& surface, const ShapePoints& shape,
                                                   const DistanceOptions& options);

/// Half of each of two sources of one pair, which have the same side first.
std::unique_ptr<SampleSource> make_half_and_half(std::unique_ptr<SampleSource> first,
                                                 std::unique_ptr<SampleSource> second);

}  // namespace palpate::contact
