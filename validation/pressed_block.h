#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "palpate/contact/contact_force.h"
#include "palpate/fem/material.h"
#include "palpate/mesh/mesh.h"

/// A soft block under a rigid indenter: what the cases of the half-space share.
namespace palpate::validation {

enum class BlockShape {
  kQuarter,       ///< of a square block: x and y in [0, L]
  kRoundQuarter,  ///< each square max(x, y) = r becomes the circle of radius r: mesh lines for round rims
  kWhole          ///< square, x and y in [-L, L]
};

/// A block, z in [-L, 0], with cells that grow away from the origin:
///     coordinates c sinh(i tau),  i = 0 .. n,   tau = ln 2/m,   n = m N,   L = c sinh(N ln 2).
/// Cells are nearly equal, c tau, up to c, and grow by 2^(1/m) from one to the next beyond.  One N more
/// doubles the block and leaves the cells that were there; a larger m refines all cells alike.
struct BlockMesh {
  double inner = 0.0;  ///< c [m]
  int per_doubling = 2, doublings = 5;
  BlockShape shape = BlockShape::kQuarter;
  double half_width() const;
  double smallest_cell() const;
  TetMesh tets() const;
};

/// The indenter: makes a source for the block's boundary, in frame 0, which is fixed in the world.
using MakeIndenter = std::function<std::unique_ptr<contact::SampleSource>(
    contact::NodeSurface block, int frame, std::shared_ptr<contact::MovingFrame> motion)>;

/// Force [N] by which the whole block pushes the indenter back, along z, in equilibrium: bottom held, sides
/// free, planes of symmetry on rollers.  Contact is queried anew until the force is settled.  NaN where no
/// equilibrium was found.
double indentation_force(const BlockMesh& mesh, const fem::Material& material, double stiffness_pa_m,
                         const MakeIndenter& indenter);

/// What a ladder tends to: v(h) = v0 + c h^p through three values with h falling; p beside it.
struct Limit {
  double value, order;
};
Limit limit_of(const std::vector<double>& h, const std::vector<double>& value);

/// Value at x = 0 of the parabola through three points.
double at_zero(const std::vector<double>& x, const std::vector<double>& value);

}  // namespace palpate::validation
