#pragma once
#include <array>
#include <string>
#include <vector>

#include "palpate/core/types.h"
#include "palpate/mesh/checks.h"

/// Polygons of files as triangles between their corners.
namespace palpate::mesh {

struct PolygonCut {
  /// Places in the list of corners; they turn as the polygon does.
  std::vector<std::array<int, 3>> triangles;
  /// Largest distance of a corner from the polygon's mean plane, divided by the largest extent.
  double warp = 0.0;
  /// False where the outline crosses or touches itself: it is no polygon, and was cut into a fan.
  bool simple = true;
};

/// Triangulates a polygon in space, concave ones included: the constrained Delaunay triangulation of its
/// projection along the mean normal (Newell), by CGAL.  A convex polygon is cut into the fan about its first
/// corner.  A hole that the outline enters and leaves along the same edge is left open.
/// @param corners  at least three, in order [m]
PolygonCut cut_polygon(const std::vector<Vec3>& corners);

/// Corners within this share of a polygon's extent are in one plane.  Files with six digits are off by at
/// most 5e-6; from a thousandth on, the choice of diagonals moves the surface by what printed figures show.
inline constexpr double kPlanar = 1e-3;

/// What the polygons of one file were.  Elements are triangles, as Provenance numbers them.
struct PolygonReport {
  int warped = 0;             ///< polygons with a corner farther from the plane than kPlanar
  int most_warped = -1;       ///< first element of the worst of them
  double largest_warp = 0.0;  ///< as PolygonCut::warp
  int crossing = 0;           ///< polygons whose outline crosses or touches itself
  int first_crossing = -1;    ///< first element of the first of them
};

/// Appends the triangles of one polygon.
/// @param points  of the file  @param polygon  its corners in `points`; a corner twice in a row counts once
void append_polygon(const std::vector<Vec3>& points, const std::vector<int>& polygon,
                    std::vector<std::array<int, 3>>& triangles, PolygonReport& report);

/// "FILE:LINE: face 3 ..." of polygons that are not planar, and of those that cross themselves; empty: none.
std::string warped_text(const PolygonReport& report, const Provenance& from);
std::string crossing_text(const PolygonReport& report, const Provenance& from);

}  // namespace palpate::mesh
