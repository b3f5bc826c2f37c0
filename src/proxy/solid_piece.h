#pragma once
#include <array>
#include <vector>

#include "palpate/mesh/mesh.h"
#include "proxy/skin_patches.h"

/// Solid cut by planes along its axes: cells of a box, and the surface within each.
namespace palpate::proxy {

/// Part of a face that lies in a cell: a convex polygon with at most three corners and one more per side of
/// the cell.
struct Polygon {
  int face = 0;
  bool is_cut = false;  ///< smaller than the face
  int count = 0;
  std::array<Vec3, 9> corner;

  Vec3 middle() const;
  Vec3 area() const;  ///< area vector, oriented as the face [m^2]
};

/// Cell and the solid's surface within it.
struct SolidPiece {
  Box cell;
  std::vector<Polygon> surface;
  std::vector<int> faces;  ///< faces with their middle in the cell, ascending: every face belongs to one
                           ///< piece
};

/// Returns the solid as one piece.
SolidPiece whole_piece(const TriMesh& surface);
/// Cuts a piece by the plane x[axis] = at; returns the parts below and above.  A polygon in the plane to
/// within `flat` [m] goes to the side of the solid that it bounds.
std::array<SolidPiece, 2> cut(const SolidPiece& piece, const TriMesh& surface, int axis, double at,
                              double flat);

/// Returns the principal axes of a surface's area as the columns of a rotation.  They make the cuts
/// independent of the solid's orientation.
Mat3 principal_axes(const TriMesh& surface);

}  // namespace palpate::proxy
