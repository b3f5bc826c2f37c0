#pragma once
#include <functional>
#include <string>
#include <vector>

#include "palpate/core/registry.h"
#include "palpate/mesh/mesh.h"
#include "palpate/mesh/skeleton.h"

/// The soft objects of Galoppo, Tekin, Otaduy, Gross and Lin (2007) and a ball, made from formulas at any
/// resolution, deterministic to the bit. x points to the left of a figure, -y is where it looks, z is up;
/// metres.
namespace palpate::shapes {

/// A body as a function of a place: negative inside, and near its surface about the signed distance [m].
using Implicit = std::function<double(const Vec3&)>;

/// One object before it is tetrahedralised.
struct Shape {
  std::string name;
  TriMesh base;  ///< smooth, closed, outwards: bounds the tetrahedra
  /// closed, outwards, with its relief; stays within a fraction of a tetrahedron's edge of the base
  TriMesh skin;
  /// polylines of sharp edges of the base, through its vertices [m]; a closed one ends where it began
  std::vector<std::vector<Vec3>> creases;
  Skeleton skeleton;   ///< bones inside the body; empty: none
  int tetrahedra = 0;  ///< how many elements the paper's object has, at least
  int nodes = 0;       ///< how many nodes; 0: as they come
  /// what `base` approximates; empty for the gear, whose base and creases say it all
  Implicit inside;
};

/// How fine; 0: the shape's own default.
struct Resolution {
  int skin_vertices = 0;  ///< met within 1 %
  int base_vertices = 0;  ///< met within 1 %
};

/// One line of the registry.
struct ShapeEntry {
  std::string name;
  std::string summary;
  Resolution usual, least;  ///< what is made when nothing is asked; what its smallest parts need
  Shape (*make)(const Resolution&);
};

/// head, human, gear, pumpkin, ball.
const std::vector<ShapeEntry>& shapes();

/// The shape called `name`.
/// @throws Error for an unknown name (with the nearest one) and for a resolution below the least
Shape make(const std::string& name, Resolution resolution = {});

}  // namespace palpate::shapes
