#pragma once
#include <cstdint>
#include <vector>

#include "palpate/dynamics/corner_term.h"
#include "palpate/dynamics/system.h"
#include "palpate/dynamics/zero_row_sum_matrix.h"

namespace palpate::dynamics {

/// Optional capability of a ForceTerm: fused assembly of a linearly implicit step. Force, product and tangent
/// are computed in one pass that shares their common intermediate results, and the tangent has zero row sums
/// (ZeroRowSumMatrix). A class inherits it in addition to ForceTerm.
class FusedStepTerm {
 public:
  virtual ~FusedStepTerm() = default;
  /// Returns whether the current tangent of the term is symmetric with zero row sums.
  virtual bool fuses_step() const { return true; }
  /// Returns a version that differs where add_step() would yield a different result at the same state and
  /// scales (materials, tangents). 0: not known; the results are then never kept.
  virtual std::uint64_t step_version() const { return 0; }
  /// Adds f += force - K shift and A += k_scale K + d_scale D. Off-diagonal blocks are stored, not added:
  /// StepAssembly is used only where no two terms write the same block.
  virtual void add_step(const StateView& state, const VecX& shift, double k_scale, double d_scale, VecX& f,
                        ZeroRowSumMatrix& A) = 0;
  /// Adds f += force - K shift - D change, without the matrix: contribution of the term to the residual of a
  /// step.
  virtual void add_step_force(const StateView& state, const VecX& shift, const VecX& change, VecX& f) = 0;
  /// Does the same where u + change = rate shift up to rounding, rate in 1/s: damping is then a function of
  /// the shift. A rate of 0 means that u + change is not proportional to the shift.
  virtual void add_step_force_at_rate(const StateView& state, const VecX& shift, const VecX& change,
                                      double /*rate*/, VecX& f) {
    add_step_force(state, shift, change, f);
  }
};

/// Optional capability of a ForceTerm: its tangent is outside the sparsity pattern of a step matrix, a
/// PointStiffness on the nodes and a SparseBorder. A class inherits it in addition to ForceTerm.
class PointStiffnessTerm {
 public:
  virtual ~PointStiffnessTerm() = default;
  /// Returns whether the current tangent of the term on the nodes is a PointStiffness: symmetric.
  virtual bool is_point_stiffness() const { return true; }
  /// Adds f += force - K shift and k_scale K + d_scale D: the nodes' part to C, rows and columns of rigid
  /// blocks to `border`, which has the size of the State's border.
  virtual void add_step(const StateView& state, const VecX& shift, double k_scale, double d_scale, VecX& f,
                        PointStiffness& C, SparseBorder& border) = 0;
  /// Adds f += force - K shift - D change.
  virtual void add_step_force(const StateView& state, const VecX& shift, const VecX& change, VecX& f) = 0;
};

/// Fused assembly of the linearly implicit steps of a system, from the FusedStepTerm, PointStiffnessTerm and
/// CornerTerm capabilities of its terms. Terms without a tangent matrix (TermTraits::zero_tangent) add their
/// force on nodes only.
///
/// The equations have two parts. That of the bodies is the part in the sparsity pattern: FusedStepTerm, dead
/// loads and the lumped masses. The part beside it has few entries and may couple other nodes in every step:
/// contact, and rigid blocks with their masses.
class StepAssembly {
 public:
  /// @param system  must outlive this object
  explicit StepAssembly(System& system) : system_(system) {}

  /// Returns whether the step at this state can be assembled in this way: every term takes part, no two of
  /// them couple the same pair of nodes, the mass is lumped, no rigid block carries nodes. Updates the
  /// pattern.
  bool applies(const StateView& state);
  /// Returns the pattern of the fused terms: the system's pattern, or, with PointStiffness terms, one without
  /// these.
  const BlockSparse& pattern() const { return any_beside_ ? pattern_ : system_.pattern(); }
  /// Assembles f = sum of (force - K shift) and A = m_scale M + d_scale D + k_scale K, with the driven
  /// directions held. The contribution of the fused terms is taken from System::kept_step() where that was
  /// made at this state and, to a relative 1e-9, for this shift and these scales. With `keep`, a newly
  /// computed contribution is stored there for reuse.
  void assemble(const StateView& state, const VecX& shift, double m_scale, double d_scale, double k_scale,
                VecX& f, ZeroRowSumMatrix& A, bool keep = false);
  /// Computes r = h sum of (force - K shift - D change) - M change, zero along driven directions, without a
  /// matrix. @pre there are no rigid blocks
  void residual(const StateView& state, const VecX& shift, const VecX& change, double h, VecX& r);

  /// Assembles the bodies' part as assemble(), without A.points and A.border.
  void assemble_bodies(const StateView& state, const VecX& shift, double m_scale, double d_scale,
                       double k_scale, VecX& f, ZeroRowSumMatrix& A, bool keep = false);
  /// Computes the bodies' part of residual(), with the rate of FusedStepTerm::add_step_force_at_rate().
  void residual_of_bodies(const StateView& state, const VecX& shift, const VecX& change, double h,
                          double rate, VecX& r);
  /// Adds f += D change of the bodies' part.
  void apply_body_damping(const StateView& state, const VecX& change, VecX& f);
  /// Assembles the part beside: b = h sum of (force - K shift - D change), zero along driven directions, and
  /// M + h D + h^2 K to A.points and A.border. The velocity changes are zero for rigid blocks; null means
  /// that all are zero.
  void assemble_beside(const StateView& state, const VecX& shift, const VecX* change, double h, VecX& b,
                       ZeroRowSumMatrix& A);

 private:
  struct Part {
    ForceTerm* term;
    FusedStepTerm* fused;  ///< null: zero tangent, point stiffness, corner, or no part in the step
    PointStiffnessTerm* beside;
    CornerTerm* corner;
  };
  /// Returns whether a part adds its force only.
  static bool is_load(const Part& part) { return !part.fused && !part.beside && !part.corner; }
  void find_parts();
  bool find_versions();
  bool is_kept(const StateView& state, const VecX& shift, double d_scale, double k_scale,
               const ZeroRowSumMatrix& A) const;
  void add_fused(const StateView& state, const VecX& shift, double d_scale, double k_scale, VecX& f,
                 ZeroRowSumMatrix& A, bool keep);
  void add_beside(const StateView& state, const VecX& shift, double m_scale, double d_scale, double k_scale,
                  VecX& f, ZeroRowSumMatrix& A);
  void add_corner(const StateView& state, const VecX& shift, double m_scale, double d_scale, double k_scale,
                  VecX& f, MatX& corner);
  void add_residual(const StateView& state, const VecX& shift, const VecX& change, double h, double rate,
                    bool beside, VecX& r);
  void update_own_pattern(const Layout& layout);

  System& system_;
  std::vector<Part> parts_;
  bool all_can_ = false, any_beside_ = false, disjoint_ = false;
  std::uint64_t pattern_version_ = 0;         ///< Pattern version that disjoint_ was determined for.
  BlockSparse pattern_;                       ///< Pattern without the PointStiffness terms.
  std::vector<std::uint64_t> step_versions_;  ///< Versions of the fused terms; empty: one of them has none.
  /// Versions of the layout and of the terms that pattern_ was built from; scratch.
  std::vector<std::uint64_t> made_of_, versions_;
  BorderedMatrix corner_;  ///< Scratch: its corner alone.
  VecX product_;           ///< Scratch.
};

}  // namespace palpate::dynamics
