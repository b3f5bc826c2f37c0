#pragma once
#include <cstdint>
#include <vector>

#include "palpate/dynamics/system.h"
#include "palpate/dynamics/zero_row_sum_matrix.h"

namespace palpate::dynamics {

/// Optional capability of a ForceTerm: fused assembly of a linearly implicit step.  Force, product and
/// tangent come from one pass over what they have in common, and the tangent has zero row sums
/// (ZeroRowSumMatrix).  A class derives from it beside ForceTerm.
class FusedStepTerm {
 public:
  virtual ~FusedStepTerm() = default;
  /// Whether the tangent that the term has at present is symmetric with zero row sums.
  virtual bool fuses_step() const { return true; }
  /// Differs where add_step() would give something else at the same state and scales: materials, tangents.
  /// 0: not known, and what it gives is never kept.
  virtual std::uint64_t step_version() const { return 0; }
  /// f += force - K shift and A += k_scale K + d_scale D.  Off-diagonal blocks are stored, not added:
  /// StepAssembly is used only where no two terms write the same block.
  virtual void add_step(const StateView& state, const VecX& shift, double k_scale, double d_scale, VecX& f,
                        ZeroRowSumMatrix& A) = 0;
  /// f += force - K shift - D change, without the matrix: the term's share of a step's residual.
  virtual void add_step_force(const StateView& state, const VecX& shift, const VecX& change, VecX& f) = 0;
};

/// Optional capability of a ForceTerm: its tangent is a PointStiffness, which stands beside the pattern of a
/// step's matrix.  A class derives from it beside ForceTerm.
class PointStiffnessTerm {
 public:
  virtual ~PointStiffnessTerm() = default;
  /// Whether the tangent that the term has at present is such a sum: symmetric and on nodes alone.
  virtual bool is_point_stiffness() const { return true; }
  /// f += force - K shift and C += k_scale K + d_scale D.
  virtual void add_step(const StateView& state, const VecX& shift, double k_scale, double d_scale, VecX& f,
                        PointStiffness& C) = 0;
  /// f += force - K shift - D change
  virtual void add_step_force(const StateView& state, const VecX& shift, const VecX& change, VecX& f) = 0;
};

/// Fused assembly of the linearly implicit steps of a system, from its terms' FusedStepTerm and
/// PointStiffnessTerm capabilities.  Terms without a tangent matrix (TermTraits::zero_tangent) add their
/// force alone.
class StepAssembly {
 public:
  /// @param system  outlives this
  explicit StepAssembly(System& system) : system_(system) {}

  /// Whether this state's step can be assembled so: every term takes part, no two of them couple the same
  /// pair of nodes, the mass is lumped, no block is rigid.  Brings the pattern up to date.
  bool applies(const StateView& state);
  /// What the fused terms couple: the system's pattern, or, with terms that stand beside it, one without
  /// these.
  const BlockSparse& pattern() const { return any_beside_ ? pattern_ : system_.pattern(); }
  /// f = sum of force - K shift, and A = m_scale M + d_scale D + k_scale K with the driven directions held.
  /// What the fused terms give is taken from System::kept_step() where that is of these scales, this state
  /// and shift, to a relative 1e-9 of shift and scales.
  /// With `keep`, what they give is kept there for the next who asks.
  void assemble(const StateView& state, const VecX& shift, double m_scale, double d_scale, double k_scale,
                VecX& f, ZeroRowSumMatrix& A, bool keep = false);
  /// r = h (sum of force - K shift - D change) - M change, zero along driven directions; without a matrix.
  void residual(const StateView& state, const VecX& shift, const VecX& change, double h, VecX& r);

 private:
  struct Part {
    ForceTerm* term;
    FusedStepTerm* fused;  ///< null: of zero tangent, beside the pattern, or it takes no part
    PointStiffnessTerm* beside;
  };
  void find_parts();
  bool find_versions();
  bool is_kept(const StateView& state, const VecX& shift, double d_scale, double k_scale,
               const ZeroRowSumMatrix& A) const;
  void add_fused(const StateView& state, const VecX& shift, double d_scale, double k_scale, VecX& f,
                 ZeroRowSumMatrix& A, bool keep);
  void update_own_pattern(const Layout& layout);

  System& system_;
  std::vector<Part> parts_;
  bool all_can_ = false, any_beside_ = false, disjoint_ = false;
  std::uint64_t pattern_version_ = 0;         ///< that disjoint_ was found for
  BlockSparse pattern_;                       ///< without the terms beside it
  std::vector<std::uint64_t> step_versions_;  ///< of the fused terms; empty: one of them has none
  /// versions of the layout and of the terms that it was made of; scratch
  std::vector<std::uint64_t> made_of_, versions_;
};

}  // namespace palpate::dynamics
