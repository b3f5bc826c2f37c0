#pragma once
#include <array>
#include <functional>
#include <memory>
#include <vector>

#include "palpate/dynamics/driven_motion.h"
#include "palpate/dynamics/force_term.h"
#include "palpate/dynamics/inertia_term.h"
#include "palpate/dynamics/kept_step.h"
#include "palpate/dynamics/linear_solver.h"
#include "palpate/dynamics/psd_projection.h"
#include "palpate/dynamics/stored_tangent.h"
#include "palpate/dynamics/zero_row_sum_matrix.h"

namespace palpate::dynamics {

/// Equations of motion M u' = sum of the force terms, q' = N(q) u, with some directions driven.
/// Independent of elements, contact and integrators.
///
/// Driven directions remain in q and u (no renumbering), but are not unknowns: in every matrix made here
/// their rows and columns are identity rows and columns, their right-hand sides are zero, and `impose` writes
/// their known values. A direction with a master block is reduced by the congruence T = [I; G]: its force and
/// tangent enter the master's rows. The tangent includes the geometric stiffness of the constraint: as G
/// rotates with the master, K of the master receives -d(G^T c)/dq, where c = f - M u' is the force that the
/// nodes exert on it.
class System {
 public:
  /// Adds a force; the order of forces affects only the order of summation.
  void add(std::shared_ptr<ForceTerm> term);
  /// Adds the mass of a block; each block has one.
  void add(std::shared_ptr<InertiaTerm> inertia);
  /// Adds driven directions; no direction may be driven twice.
  void add(std::shared_ptr<DrivenMotion> motion);
  /// Sets the solver of M a = f. Needed where a mass matrix is not diagonal.
  void set_mass_solver(std::unique_ptr<LinearSolver> solver);
  /// Builds masks, maps and scratch memory. Called after the last add and whenever the layout changed.
  /// @throws Error where a direction is driven twice
  void prepare(const StateView& state);

  /// Returns the force terms in the order in which they were added.
  const std::vector<std::shared_ptr<ForceTerm>>& terms() const { return terms_; }
  /// Returns the inertia terms in the order in which they were added.
  const std::vector<std::shared_ptr<InertiaTerm>>& inertias() const { return inertias_; }
  /// Returns one entry per u-direction: true where it is driven.
  const std::vector<char>& driven_mask() const { return driven_mask_; }
  /// Returns the driven u-directions, ascending.
  const std::vector<int>& driven_dofs() const { return driven_dofs_; }
  /// Returns whether any direction is driven.
  bool any_driven() const { return !driven_dofs_.empty(); }
  /// Returns whether any driven direction has a master.
  bool any_master() const { return any_master_; }
  bool symmetric() const;  ///< Returns whether the tangents of all terms are symmetric.
  /// Switches the projection of the tangents of all terms that support it (PsdProjectedTerm).
  void project_to_psd(bool on);
  /// Returns whether project_to_psd() is on.
  bool projects_to_psd() const { return projects_to_psd_; }
  /// Returns the number of root functions of all terms, in the order of the terms (event location).
  int event_count() const;
  /// Increases whenever the meaning of one of the functions changed.
  std::uint64_t events_version() const;
  /// Evaluates the root functions; g receives event_count() values.
  void events(const StateView& state, double* g) const;
  /// Returns the first diagnostic with a valid element, and the name of its term; element -1 where there is
  /// none.
  std::pair<Diagnostic, std::string> inspect(const StateView& state) const;
  long clamped_tangents() const;  ///< Returns the sum of ForceTerm::clamped_tangents() over all terms.

  /// Selects terms: true for those that take part.
  using TermFilter = std::function<bool(const TermTraits&)>;

  /// Writes the driven q and u for time t into vectors of the layout's size.
  void impose(const Layout& layout, double t, double* q, double* u) const;
  /// Computes the sum of forces on every direction, driven ones included [N]. `filter` selects terms (empty:
  /// all).
  void force(const StateView& state, VecX& f, const TermFilter& filter = {});
  /// Computes u': M^-1 f on free directions, the prescribed acceleration on driven ones.
  void acceleration(const StateView& state, VecX& a);
  /// Computes u' from a force already evaluated (f is changed: reduced to the free directions).
  void acceleration_of_force(const StateView& state, VecX& f, VecX& a);
  /// Assembles A = m_scale M + d_scale D + k_scale K, with driven rows and columns replaced by the identity
  /// (reduced to masters where they have one). Rebuilds the pattern when the version of a term increased.
  void step_matrix(const StateView& state, double m_scale, double d_scale, double k_scale, BorderedMatrix& A,
                   const TermFilter& filter = {});
  /// Updates and returns the pattern of step_matrix(): all force terms and masses, as they are now.
  const BlockSparse& updated_pattern(const StateView& state);
  /// Returns the pattern as of the last updated_pattern() or step_matrix().
  const BlockSparse& pattern() const { return pattern_; }
  /// Returns the pairs of nodes that a term couples in that pattern, including each node with itself where
  /// the term adds it.
  const NodePairs& node_pairs(std::size_t term) const { return term_pairs_[term].pairs; }
  /// Returns the lumped masses of the nodal u-directions [kg]; empty where the mass is not lumped.
  const VecX& nodal_mass() const { return nodal_mass_; }
  /// Returns the mean of nodal_mass() [kg]; 0 where it is empty.
  double mean_nodal_mass() const { return mean_nodal_mass_; }
  /// Returns the nodes with driven directions.
  const std::vector<HeldNode>& driven_nodes() const { return driven_nodes_; }
  /// Computes y = M x on all directions.
  void apply_mass(const StateView& state, const VecX& x, VecX& y) const;
  /// Adds the driven entries of a residual to their masters' rows, then sets them to zero.
  void reduce(const StateView& state, VecX& r) const;
  /// Sets the driven entries of a velocity change from those of their masters (G x_master), or to zero.
  void expand(const StateView& state, VecX& x) const;
  /// Adds y += K x on masters' rows, with K the geometric stiffness of the constraints (included in
  /// step_matrix); does nothing without masters.
  void apply_carried_stiffness(const StateView& state, const VecX& x, VecX& y, const TermFilter& filter = {});
  /// Computes r = M u' - f on free directions for a given u' (whose driven entries are replaced by the
  /// prescribed ones), 0 on driven ones.
  void residual(const StateView& state, const VecX& acceleration, VecX& r);
  /// Computes the forces [N] that the drives exert on the driven directions: M a - f there, zero elsewhere.
  /// For carried nodes this is the force exerted by their master.
  void reactions(const StateView& state, VecX& r);
  /// Returns the power [W] of the drives that follow prescribed paths: their forces on the directions without
  /// a master.
  double support_power(const StateView& state);

  /// Returns the contribution of the fused terms, as stored by StepAssembly::assemble() with `keep`.
  CachedStep& kept_step() { return kept_step_; }
  const CachedStep& kept_step() const { return kept_step_; }  ///< As above, read-only.

  double kinetic_energy(const StateView& state) const;  ///< Returns 1/2 u M u [J].
  double potential_energy(const StateView& state);      ///< Returns the sum over all terms [J].

 private:
  /// One motion with its place in the layout, its values at the last evaluation, and its G.
  struct Driven {
    std::shared_ptr<DrivenMotion> motion;
    int master_offset = -1;  ///< Offset of the master's u; -1 without a master.
    int master_size = 0;
    VecX x, v, a, c;  ///< c: force of the carried directions on their master [N].
    MatX G, K;        ///< K: geometric stiffness under c, at the last evaluate_carried_stiffness.
  };
  void update_pattern(const StateView& state);
  void ensure_pattern(const StateView& state, BorderedMatrix& A);
  void evaluate_driven(const StateView& state) const;
  void reduce_to_masters(const StateView& state, BorderedMatrix& A) const;
  void evaluate_carried_stiffness(const StateView& state, const TermFilter& filter);
  void find_driven_slots(const BlockSparse& A) const;
  void eliminate_driven(BorderedMatrix& A) const;
  void solve_mass(const StateView& state, VecX& r, VecX& a);
  void assemble_tangents(const StateView& state, double d_scale, double k_scale, BorderedMatrix& A,
                         const TermFilter& filter);
  void assemble_mass(const StateView& state, BorderedMatrix& A);

  std::vector<std::shared_ptr<ForceTerm>> terms_;
  std::vector<StoredTangentTerm*> stored_tangents_;  ///< One per term; null where it lacks the capability.
  std::vector<PsdProjectedTerm*> projected_terms_;   ///< Terms with the capability.
  std::vector<std::shared_ptr<InertiaTerm>> inertias_;
  mutable std::vector<Driven> driven_;
  std::unique_ptr<LinearSolver> mass_solver_;
  BorderedMatrix mass_;
  std::uint64_t mass_layout_ = 0;  ///< Layout version that the pattern of `mass_` was built for.
  bool nodal_mass_diagonal_ = true;
  bool any_master_ = false;
  bool projects_to_psd_ = false;
  VecX nodal_mass_, inverse_nodal_mass_;
  double mean_nodal_mass_ = 0.0;
  /// Per term, whether its tangent is already in the matrix under assembly.
  std::vector<char> term_is_in_;
  std::vector<char> driven_mask_;
  std::vector<int> driven_dofs_;
  std::vector<HeldNode> driven_nodes_;
  mutable std::uint64_t driven_pattern_ = 0;  ///< Pattern version that `driven_mirrors_` was computed for.
  /// Slot of (j, i) for each block (i, j) in the rows of the driven nodes, in order.
  mutable std::vector<int> driven_mirrors_;
  /// Hash of the pattern versions of the layout and of the terms that `pattern_` was built from.
  std::uint64_t pattern_key_ = 0;
  BlockSparse pattern_;
  struct TermPairs {
    bool known = false;
    std::uint64_t version = 0;
    NodePairs pairs;
  };
  std::vector<TermPairs> term_pairs_;  ///< Pairs of each term, at its version.
  NodePairs mass_pairs_;
  std::uint64_t pairs_layout_ = 0;  ///< Layout version that the pairs were computed for.
  CachedStep kept_step_;
  mutable VecX scratch_, known_;
  VecX force_scratch_, held_scratch_, acceleration_scratch_;
};

}  // namespace palpate::dynamics
