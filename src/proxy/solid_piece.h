#pragma once
#include <array>
#include <vector>

#include "palpate/mesh/mesh.h"
#include "proxy/skin_patches.h"

/// A solid cut by planes along its axes: cells of a box, and the surface within each.
namespace palpate::proxy {

/// The part of a face that lies in a cell: convex, by its corners;
/// at most 3 and one for each of the cell's sides.
struct Polygon {
  int face = 0;
  bool is_cut = false;  ///< less than the face
  int count = 0;
  std::array<Vec3, 9> corner;

  Vec3 middle() const;
  Vec3 area() const;  ///< its area vector, as the face's [m^2]
};

struct SolidPiece {
  Box cell;
  std::vector<Polygon> surface;
  std::vector<int> faces;  ///< those with their middle in the cell, ascending: every face is one piece's
};

/// The solid as one piece.
SolidPiece whole_piece(const TriMesh& surface);
/// What lies below and above the plane x[axis] = at.
/// What is in it to within `flat` is where the solid is that it bounds.
std::array<SolidPiece, 2> cut(const SolidPiece& piece, const TriMesh& surface, int axis, double at,
                              double flat);

/// Principal axes of a surface's area, a rotation's columns: a solid is cut alike however it is turned.
Mat3 principal_axes(const TriMesh& surface);

}  // namespace palpate::proxy
