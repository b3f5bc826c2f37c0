#pragma once
#include <algorithm>
#include <array>
#include <functional>
#include <vector>

#include "distance/skin.h"

namespace palpate::distance {

/// Largest number of segments per face edge: 256 triangles per face.
inline constexpr int kMostCuts = 16;

/// Material point of a skin at which the gap is evaluated.
struct ContactPoint {
  int face = 0;       ///< Face that contains the point.
  Vec3 weights;       ///< Barycentric weights of the face's corners; sum 1.
  double area = 0.0;  ///< Integral of the point's hat function: a third of its triangles' area at rest [m^2].
};

/// Triangle of the contact mesh: part of a face, spanned by three contact points.
struct ContactTriangle {
  std::array<int, 3> points{};  ///< Contact points, in the orientation of the face.
  double area = 0.0;            ///< Area at rest [m^2].
  double lowered = 0.0;  ///< Mean height above the triangle of the curved surface that it approximates [m].
};

/// Contact mesh of a skin: the triangles over which the gap is interpolated linearly, and their corners.
struct ContactMesh {
  std::vector<ContactPoint> points;        ///< Contact points, ordered by face.
  std::vector<ContactTriangle> triangles;  ///< Triangles, ordered by face.
  std::vector<int> fan_begin;  ///< Offset of each point's triangles in `fan`, and its length at the end.
  std::vector<int> fan;        ///< Triangles around each point.
};

/// Returns the number n of segments into which the edges of a face are divided, so that none is longer than
/// `spacing` at rest. It is at least 1 and at most kMostCuts.
/// @param spacing  longest permitted segment [m]; infinite: faces are not divided
int cuts_of(const Skin& skin, int face, double spacing);

/// Divides each face into n^2 similar triangles, with n from cuts_of(). Faces with equal n share the points
/// on their common edge, about half a point per triangle; on an edge between faces of different n each face
/// has separate points. A shared point is assigned to the first face that contains it.
/// @param spacing  longest edge of the triangles [m], as for cuts_of()
/// @throws Error where the spacing is not positive
ContactMesh contact_mesh(const Skin& skin, double spacing);

/// Corrects areas and mean heights of the triangles (ContactTriangle::area, ContactTriangle::lowered) and the
/// areas of the points for the curved surface that the triangles' corners lie on.
/// @param at    positions of the mesh's points [m], one per column
/// @param onto  returns the point of the surface nearest to x [m]
void fit_to_surface(ContactMesh& mesh, const Points& at, const std::function<Vec3(const Vec3&)>& onto);

}  // namespace palpate::distance
