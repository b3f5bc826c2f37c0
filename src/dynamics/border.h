#pragma once
#include "palpate/dynamics/matrix.h"

namespace palpate::dynamics {

/// Resizes the border of a matrix; does nothing where it has this size.
inline void resize_border(BorderedMatrix& A, int nodal, int border) {
  if (A.right.rows() == nodal && A.corner.rows() == border) return;
  A.right.resize(nodal, border);
  A.bottom.resize(border, nodal);
  A.corner.resize(border, border);
}

}  // namespace palpate::dynamics
