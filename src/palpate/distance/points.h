#pragma once
#include <algorithm>
#include <array>
#include <functional>
#include <vector>

#include "palpate/distance/skin.h"

namespace palpate::distance {

/// Largest number of parts of a face's edges: 256 triangles per face.
inline constexpr int kMostCuts = 16;

/// A material point of a skin.
struct ContactPoint {
  int face = 0;       ///< that carries it
  Vec3 weights;       ///< of the face's corners; sum 1
  double area = 0.0;  ///< integral of its hat: a third of its triangles' area at rest [m^2]
};

/// A part of a face, between three contact points.
struct ContactTriangle {
  std::array<int, 3> points{};  ///< in the face's order
  double area = 0.0;            ///< at rest [m^2]
  double lowered = 0.0;         ///< how far the surface that it stands for lies above it, in the mean [m]
};

/// The triangles over which a contact takes the gap as linear, and their corners.
struct ContactMesh {
  std::vector<ContactPoint> points;        ///< ordered by face
  std::vector<ContactTriangle> triangles;  ///< ordered by face
  std::vector<int> fan_begin;              ///< of each point, in `fan`, and the end
  std::vector<int> fan;                    ///< triangles around each point
};

/// Returns the number n of parts of a face's edges, such that none is longer than `spacing` at rest; 1 where
/// the face is smaller, at most kMostCuts.
/// @param spacing  [m]; infinite: every face as it is
int cuts_of(const Skin& skin, int face, double spacing);

/// Cuts each face into n^2 similar triangles, n of cuts_of().  Their corners are shared by faces that are cut
/// alike, half a point per triangle; on an edge between faces of different n each has its own.  A point
/// belongs to the first face that has it.
/// @param spacing  longest edge of the triangles [m], as for cuts_of()
/// @throws Error where the spacing is not positive
ContactMesh contact_mesh(const Skin& skin, double spacing);

/// Fits triangles to the curved surface that their corners lie on: their areas, and how far it bulges over
/// them.
/// @param at    places of the mesh's points [m]
/// @param onto  the surface's point nearest to x
void fit_to_surface(ContactMesh& mesh, const Points& at, const std::function<Vec3(const Vec3&)>& onto);

}  // namespace palpate::distance
