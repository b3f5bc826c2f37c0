#pragma once

/// Loops over vertices and faces of a region as plain functions on plain data: face_lanes.cpp, compiled for
/// each instruction set (raster_kernels.h says why there is no inline function here).
namespace palpate::contact {

struct FaceKernels {
  /// Points in a region's axes, R (x - o).
  /// @param world  x y z of each  @param rows  of R, row by row
  /// @param out  room for x y z of each  @param wide  the same, and a fourth number of each
  void (*to_axes)(const double* world, int count, const double rows[9], const double origin[3], double* out,
                  double* wide);
  /// Bounds of some faces, `low` and `high` in the first three of four numbers.
  /// @param wide  as to_axes made it  @param corners  three a face
  /// @returns  the least of (twice) their areas along the third axis, times `side`
  double (*bound)(const double* wide, const int* corners, int count, double side, double low[4],
                  double high[4]);
};

const FaceKernels& best_face_kernels();

}  // namespace palpate::contact
