#pragma once
#include <functional>
#include <string>
#include <vector>

#include "palpate/core/registry.h"
#include "palpate/mesh/mesh.h"
#include "palpate/mesh/skeleton.h"

/// The soft objects of Galoppo, Tekin, Otaduy, Gross and Lin (2007) and a ball, generated from formulas at
/// any resolution, bitwise deterministic.  Axes: x points to the left of a figure, -y is its viewing
/// direction, z is up; metres.
namespace palpate::shapes {

/// Implicit body: negative inside, and approximately the signed distance near its surface [m].
using Implicit = std::function<double(const Vec3&)>;

/// One object before tetrahedralisation.
struct Shape {
  std::string name;
  TriMesh base;  ///< smooth, closed, outwards: boundary of the tetrahedra
  /// Visible surface with its relief, closed, outwards; stays within a fraction of a tetrahedron's edge of
  /// the base.
  TriMesh skin;
  /// Polylines of sharp edges of the base, through its vertices [m]; the last point of a closed line is its
  /// first.
  std::vector<std::vector<Vec3>> creases;
  Skeleton skeleton;   ///< bones inside the body; empty: none
  int tetrahedra = 0;  ///< least number of elements, as in the paper
  int nodes = 0;       ///< number of nodes, as in the paper; 0: no target
  /// Implicit body that `base` approximates; empty for the gear, which `base` and `creases` define.
  Implicit inside;
};

/// Resolution of the surfaces; 0: default of the shape.
struct Resolution {
  int skin_vertices = 0;  ///< met within 1 %
  int base_vertices = 0;  ///< met within 1 %
};

/// Entry of the registry of shapes.
struct ShapeEntry {
  std::string name;
  std::string summary;
  Resolution usual, least;  ///< default; least that resolves the smallest parts
  Shape (*make)(const Resolution&);
};

/// Returns the registry: head, human, gear, pumpkin, ball.
const std::vector<ShapeEntry>& shapes();

/// Makes the shape called `name`.
/// @throws Error for an unknown name (with the nearest one) and for a resolution below the least
Shape make(const std::string& name, Resolution resolution = {});

}  // namespace palpate::shapes
