#pragma once

/// Loops over vertices and faces of a region as plain functions on plain data: face_lanes.cpp, compiled for
/// each instruction set, of which all give the same bits (raster_kernels.h says why there is no inline
/// function here).
namespace palpate::contact {

struct FaceKernels {
  /// Points in a region's axes, R (x - o) [m].
  /// @param world  x y z of each  @param rows  of R, row by row
  /// @param out  room for x y z of each  @param wide  room for the same, padded to four numbers each
  void (*to_axes)(const double* world, int count, const double rows[9], const double origin[3], double* out,
                  double* wide);
  /// Bounding box of some faces, in the first three of four numbers [m].
  /// @param wide  vertices as to_axes made them  @param corners  three vertices a face
  /// @returns  the least of twice the faces' signed areas along the third axis, times `side` [m^2]
  double (*bound)(const double* wide, const int* corners, int count, double side, double low[4],
                  double high[4]);
};

const FaceKernels& best_face_kernels();

}  // namespace palpate::contact
