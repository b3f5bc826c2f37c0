#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "palpate/contact/contact_force.h"
#include "palpate/contact/side.h"
#include "palpate/fem/material.h"
#include "palpate/mesh/mesh.h"

/// Soft block under a rigid indenter, shared by the half-space cases.
namespace palpate::validation {

enum class BlockShape {
  kQuarter,       ///< Quarter of a square block: x and y in [0, L].
  kRoundQuarter,  ///< Each square max(x, y) = r becomes the circle with radius r: mesh lines for round rims.
  kWhole          ///< Square, x and y in [-L, L].
};

/// Block, z in [-L, 0], with cells that grow away from the origin:
///     coordinates c sinh(i tau),  i = 0 .. n,   tau = ln 2/m,   n = m N,   L = c sinh(N ln 2).
/// Cells are nearly equal, c tau, up to c, and grow by 2^(1/m) from one to the next beyond. Increasing N by
/// one doubles the block and leaves the existing cells unchanged; a larger m refines all cells equally.
struct BlockMesh {
  double inner = 0.0;  ///< c [m]
  int per_doubling = 2, doublings = 5;
  BlockShape shape = BlockShape::kQuarter;
  double half_width() const;
  double smallest_cell() const;
  TetMesh tets() const;
};

/// Makes the indenter: a source for the block's boundary, in frame 0, which is fixed in the world.
using MakeIndenter = std::function<std::unique_ptr<contact::SampleSource>(
    contact::NodeSurface block, int frame, std::shared_ptr<contact::MovingFrame> motion)>;

/// Returns the force [N] along z of the whole block on the indenter in equilibrium: bottom held, sides free,
/// planes of symmetry on rollers. Contact is queried until the force has converged. NaN if no equilibrium is
/// found.
double indentation_force(const BlockMesh& mesh, const fem::Material& material, double stiffness_pa_m,
                         const MakeIndenter& indenter);

/// Limit of a refinement sequence: v(h) = v0 + c h^p through three values with h falling, and p.
struct Limit {
  double value, order;
};
Limit limit_of(const std::vector<double>& h, const std::vector<double>& value);

/// Returns the value at x = 0 of the parabola through three points.
double at_zero(const std::vector<double>& x, const std::vector<double>& value);

}  // namespace palpate::validation
