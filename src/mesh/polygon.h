#pragma once
#include <array>
#include <string>
#include <vector>

#include "mesh/provenance.h"
#include "palpate/core/types.h"

/// Triangulation of the polygons of files, without new vertices.
namespace palpate::mesh {

/// Triangulation of one polygon.
struct PolygonCut {
  /// Indices into the list of corners, oriented like the polygon.
  std::vector<std::array<int, 3>> triangles;
  /// Largest distance of a corner from the polygon's mean plane, relative to its largest extent.
  double warp = 0.0;
  /// False if the outline crosses or touches itself: the polygon is invalid, and was cut into a fan.
  bool simple = true;
};

/// Triangulates a polygon in space, convex or concave: the constrained Delaunay triangulation of its
/// projection along the mean normal (Newell), by CGAL.  A convex polygon is cut into the fan about its first
/// corner.  A hole that the outline enters and leaves along the same edge is left open.
/// @param corners  at least three, in order [m]
PolygonCut cut_polygon(const std::vector<Vec3>& corners);

/// Corners within this share of a polygon's extent count as planar.  Files with six digits deviate by at most
/// 5e-6; from a thousandth on, the choice of diagonals moves the surface enough to change printed figures.
inline constexpr double kPlanar = 1e-3;

/// Report on the polygons of one file.  Elements are triangles, as Provenance numbers them.
struct PolygonReport {
  int warped = 0;             ///< polygons that deviate from their plane by more than kPlanar
  int most_warped = -1;       ///< first element of the worst one
  double largest_warp = 0.0;  ///< as PolygonCut::warp
  int crossing = 0;           ///< polygons whose outline crosses or touches itself
  int first_crossing = -1;    ///< first element of the first one
};

/// Appends the triangles of one polygon, and updates the report.
/// @param points   points of the file
/// @param polygon  its corners as indices into `points`; a corner repeated in a row counts once
void append_polygon(const std::vector<Vec3>& points, const std::vector<int>& polygon,
                    std::vector<std::array<int, 3>>& triangles, PolygonReport& report);

/// Returns "FILE:LINE: face 3 ..." for polygons that are not planar; empty: none.
std::string warped_text(const PolygonReport& report, const Provenance& from);
/// Returns "FILE:LINE: face 3 ..." for polygons whose outline crosses or touches itself; empty: none.
std::string crossing_text(const PolygonReport& report, const Provenance& from);

}  // namespace palpate::mesh
