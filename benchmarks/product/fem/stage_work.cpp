#include "product/fem/stage_work.h"

#include <algorithm>

#include "palpate/core/error.h"

namespace palpate::bench {
namespace {

// Bytes.
// - Element: six numbers of its rest shape and its volume, four node numbers of two bytes each; six more
//   edge numbers for the matrix.
// - Block: nine doubles; in the single-precision copy nine floats and a column; eight bytes of map between
//   the two.
// - Vector: three doubles per node, in the solver four.
constexpr double kElement = 64.0, kEdges = 12.0, kBlock = 72.0, kMap = 8.0, kCopy = 36.0, kColumn = 4.0;
// Fused assembly: the slot of a block above the diagonal in the copy, which is the only matrix; masses are
// stored separately.
constexpr double kSlot = 6.0;
constexpr double kVector = 24.0, kSolverVector = 32.0, kSingleVector = 16.0, kInverse = 48.0;

// Operations of an element, counted in the formulas of lane_element.h, lane_rotation.h and lane_blocks.h; a
// division counts as one, Newton's method takes four steps.
constexpr double kGradient = 36.0, kRotation = 334.0, kForceTail = 105.0, kProductTail = 196.0,
                 kBlocks = 383.0;
// Fused assembly: both stresses, and one sum into the nodes.
constexpr double kStepTail = 244.0;
// Damping adds the stress of the strain rate and its image to a force. The exact tangent adds the coupling
// matrix, [h_a]x C, and its part of six blocks.
constexpr double kDampingTail = 114.0, kCoupled = 276.0;
// A block is scaled (or added to the row sum) and multiplied in double once for each start; an iteration
// takes one product. Node operations in an iteration: update, preconditioner, direction.
constexpr double kFactorOfBlock = 9.0, kStartOfBlock = 18.0, kProductOfBlock = 18.0, kIterationOfNode = 50.0;

}  // namespace

double StageWork::limit_ms(const MachineLimits& limits, double working_set) const {
  const double bytes_ms =
      1e-6 * (read_bytes / limits.read_gb_s(working_set) + written_bytes / limits.write_gb_s(working_set));
  const double flops_ms = 1e-6 * (single_flops / limits.gflop_s + double_flops / limits.double_gflop_s);
  return std::max(bytes_ms, flops_ms);
}

StepWork work_of(const StepCounts& c) {
  StepWork w;
  const double pairs = 0.5 * (c.blocks - c.nodes), triangle = c.fused ? pairs : pairs + c.nodes;
  // Forces, and the product of the tangent with the velocity: x is read once, then x and u once, and both
  // accumulate into a result.
  w.force = {.read_bytes = 2.0 * kElement * c.tetrahedra + 5.0 * kVector * c.nodes,
             .written_bytes = 2.0 * kVector * c.nodes,
             .double_flops = (3.0 * kGradient + 2.0 * kRotation + kForceTail + kProductTail) * c.tetrahedra};
  w.matrix = {.read_bytes = (kElement + kEdges) * c.tetrahedra + kVector * c.nodes + kMap * c.blocks,
              .written_bytes = kBlock * c.blocks,
              .double_flops = (kGradient + kRotation + kBlocks) * c.tetrahedra};
  w.factor = {
      .read_bytes = (kBlock + kMap) * c.blocks + c.starts * kSingleVector * c.nodes,
      .written_bytes = kCopy * (c.blocks + triangle) + (c.starts * kSingleVector + kInverse) * c.nodes,
      .single_flops = c.starts * kStartOfBlock * c.blocks,
      .double_flops = kFactorOfBlock * c.blocks};
  // x, u, the shift and f once, single precision out; the right-hand side is a few vectors; the
  // preconditioner reads the written matrix.
  if (c.fused) {
    w.matrix = {.read_bytes = (kElement + kEdges) * c.tetrahedra + 4.0 * kVector * c.nodes + kSlot * pairs,
                .written_bytes = kVector * c.nodes + kCopy * pairs,
                .double_flops = (2.0 * kGradient + kRotation + kStepTail + kBlocks) * c.tetrahedra};
    w.force = {.read_bytes = kVector * c.nodes, .written_bytes = kVector * c.nodes};
    w.factor = {
        .read_bytes = (kCopy + kMap) * pairs + (c.starts * kSingleVector + kVector) * c.nodes,
        .written_bytes = kCopy * triangle +
                         (c.starts * kSingleVector + kInverse + kSolverVector + kSingleVector) * c.nodes,
        .single_flops = (kFactorOfBlock + c.starts * kStartOfBlock) * c.blocks};
  }
  // Residual: x, u, the shift, the change and the masses once, f written; no matrix.
  if (c.lagged) {
    w.force = {.read_bytes = kElement * c.tetrahedra + 6.0 * kVector * c.nodes,
               .written_bytes = kVector * c.nodes,
               .double_flops = (2.0 * kGradient + kRotation + kStepTail) * c.tetrahedra};
    w.matrix = w.factor = {};
  }
  // Iteration: direction (z, p to p), product (p to q, and the masses), update (p, q, d, r and the inverse to
  // d, r, z).
  const double vectors = c.fused ? 8.0 : 7.0;
  w.solve = {.read_bytes = c.iterations *
                           ((kCopy + kColumn) * triangle + (vectors * kSingleVector + kInverse) * c.nodes),
             .written_bytes = c.iterations * 5.0 * kSingleVector * c.nodes,
             .single_flops = c.iterations * (kProductOfBlock * c.blocks + kIterationOfNode * c.nodes)};
  w.solve_working_set = (kCopy + kColumn) * triangle + (5.0 * kSingleVector + kInverse) * c.nodes;
  w.working_set = bytes_to_store(c);
  return w;
}

StageWork element_work(const std::string& stage, const StepCounts& c) {
  StepCounts general = c, fused = c, lagged = c;
  general.fused = general.lagged = false;
  fused.fused = lagged.lagged = true;
  if (stage == "fused assembly") return work_of(fused).matrix;
  if (stage == "residual") return work_of(lagged).force;
  if (stage.starts_with("tangent")) {
    StageWork work = work_of(general).matrix;
    if (stage == "tangent, exact") work.double_flops += kCoupled * c.tetrahedra;
    return work;
  }
  const bool damped = stage == "force, damped";
  PALPATE_CHECK(damped || stage == "force", "the work of the stage \"{}\" is unknown", stage);
  return {.read_bytes = kElement * c.tetrahedra + (damped ? 3.0 : 2.0) * kVector * c.nodes,
          .written_bytes = kVector * c.nodes,
          .double_flops = (kGradient + kRotation + kForceTail + (damped ? kGradient + kDampingTail : 0.0)) *
                          c.tetrahedra};
}

double bytes_to_store(const StepCounts& c) {
  const double pairs = 0.5 * (c.blocks - c.nodes), elements = (kElement + kEdges) * c.tetrahedra;
  // The copy, and the map by which it is filled.
  const double packing = (kCopy + kColumn + kColumn) * (c.fused ? pairs : pairs + c.nodes);
  const double matrix =
      c.fused ? kColumn * c.blocks + (kCopy + kSlot) * pairs : (kBlock + kColumn + kMap + kCopy) * c.blocks;
  // q, u, two per attempt, force, product, right-hand side, change; in the solver b, x, A x, starts with
  // their products, and five in single precision.
  const double vectors =
      (10.0 * kVector + 3.0 * kSolverVector + (2.0 * c.starts + 5.0) * kSingleVector + kInverse) * c.nodes;
  return elements + packing + matrix + vectors;
}

}  // namespace palpate::bench
