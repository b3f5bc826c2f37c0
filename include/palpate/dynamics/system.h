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

/// M u' = sum of the force terms, q' = N(q) u, with some directions driven.  Knows no element, no contact, no
/// integrator.
///
/// Driven directions stay in q and u (no renumbering), but not among the unknowns: their rows and columns of
/// every matrix made here are those of the identity, their right-hand sides are zero, and `impose` writes
/// their known values. A direction with a master block is reduced by the congruence T = [I; G]: its force and
/// tangent enter the master's rows, and with the tangent comes the geometric stiffness of the constraint: as
/// G rotates with the master, K of the master gets -d(G^T c)/dq, where c = f - M u' is the force that the
/// nodes exert on it.
class System {
 public:
  /// A force; its order among others decides the order of sums alone.
  void add(std::shared_ptr<ForceTerm> term);
  /// The mass of a block; each block has one.
  void add(std::shared_ptr<InertiaTerm> inertia);
  /// Directions that are given; none is driven twice.
  void add(std::shared_ptr<DrivenMotion> motion);
  /// Needed where a mass matrix is not diagonal: M a = f is then solved by this.
  void set_mass_solver(std::unique_ptr<LinearSolver> solver);
  /// Call after the last add and whenever the layout changed: masks, maps, scratch memory.
  void prepare(const StateView& state);

  /// In the order in which they were added.
  const std::vector<std::shared_ptr<ForceTerm>>& terms() const { return terms_; }
  /// In the order in which they were added.
  const std::vector<std::shared_ptr<InertiaTerm>>& inertias() const { return inertias_; }
  /// One entry a u-direction: true where it is driven.
  const std::vector<char>& driven_mask() const { return driven_mask_; }
  /// u-directions that are driven, ascending.
  const std::vector<int>& driven_dofs() const { return driven_dofs_; }
  /// Whether any direction is driven.
  bool any_driven() const { return !driven_dofs_.empty(); }
  bool symmetric() const;  ///< all terms' tangents are
  /// Projects the tangents of all terms that can be (PsdProjectedTerm), or no longer.
  void project_to_psd(bool on);
  /// Whether project_to_psd() is on.
  bool projects_to_psd() const { return projects_to_psd_; }
  /// Root functions of all terms, one after the other (event location).
  int event_count() const;
  /// Grows whenever the meaning of one of the functions changed.
  std::uint64_t events_version() const;
  /// g receives event_count() values.
  void events(const StateView& state, double* g) const;
  /// The first term's diagnostic that names an element, with the term's name; element -1 where none does.
  std::pair<Diagnostic, std::string> inspect(const StateView& state) const;
  long clamped_tangents() const;  ///< sum over all terms

  /// Which terms take part: true for those that do.
  using TermFilter = std::function<bool(const TermTraits&)>;

  /// Writes the driven q and u for time t into vectors of the layout's size.
  void impose(const Layout& layout, double t, double* q, double* u) const;
  /// Sum of forces on every direction, driven ones included [N].  `filter` picks terms (empty: all).
  void force(const StateView& state, VecX& f, const TermFilter& filter = {});
  /// u' : M^-1 f on free directions, the given acceleration on driven ones.
  void acceleration(const StateView& state, VecX& a);
  /// u' from a force already evaluated (f is changed: reduced onto the free directions).
  void acceleration_of_force(const StateView& state, VecX& f, VecX& a);
  /// A = m_scale M + d_scale D + k_scale K, driven rows and columns replaced by the identity (reduced onto
  /// masters where they have one).  Rebuilds the pattern when a term's version grew.
  void step_matrix(const StateView& state, double m_scale, double d_scale, double k_scale, BorderedMatrix& A,
                   const TermFilter& filter = {});
  /// The pattern of step_matrix(): that of all force terms and masses, as they are now.
  const BlockSparse& updated_pattern(const StateView& state);
  /// The pattern as it was at the last updated_pattern() or step_matrix().
  const BlockSparse& pattern() const { return pattern_; }
  /// Pairs of nodes that a term couples, a node with itself included, in that pattern.
  const NodePairs& node_pairs(std::size_t term) const { return term_pairs_[term].pairs; }
  /// Masses of the nodal u-directions where they are lumped [kg]; empty where they are not.
  const VecX& nodal_mass() const { return nodal_mass_; }
  /// Mean of nodal_mass() [kg]; 0 where it is empty.
  double mean_nodal_mass() const { return mean_nodal_mass_; }
  /// Nodes with driven directions.
  const std::vector<HeldNode>& driven_nodes() const { return driven_nodes_; }
  /// y = M x, all directions
  void apply_mass(const StateView& state, const VecX& x, VecX& y) const;
  /// Zeroes the driven entries of a residual, after adding their reduction to the masters' rows.
  void reduce(const StateView& state, VecX& r) const;
  /// The other way: the driven entries of a velocity change follow those of their masters (G x_master), or
  /// are zero.
  void expand(const StateView& state, VecX& x) const;
  /// y += K x on masters' rows, K the geometric stiffness of the constraints (step_matrix includes it);
  /// nothing without masters.
  void apply_carried_stiffness(const StateView& state, const VecX& x, VecX& y, const TermFilter& filter = {});
  /// r = M u' - f on free directions for a given u' (driven entries of which are replaced by what drives
  /// them), 0 on driven ones.
  void residual(const StateView& state, const VecX& acceleration, VecX& r);
  /// Forces [N] that the drives exert on the driven directions: M a - f there, zero elsewhere.  Of carried
  /// nodes, what their master exerts on them.
  void reactions(const StateView& state, VecX& r);
  /// Power [W] of the drives that follow given paths: their forces on the directions that no master carries.
  double support_power(const StateView& state);

  /// What StepAssembly::assemble() was asked to keep of the fused terms.
  KeptStep& kept_step() { return kept_step_; }
  const KeptStep& kept_step() const { return kept_step_; }  ///< likewise

  double kinetic_energy(const StateView& state) const;  ///< 1/2 u M u [J]
  double potential_energy(const StateView& state);      ///< sum over terms [J]

 private:
  struct Driven {  ///< one motion with its place in the layout, its values at the last evaluation, and its G
    std::shared_ptr<DrivenMotion> motion;
    int master_offset = -1;  ///< of the master's u, -1 without one
    int master_size = 0;
    VecX x, v, a, c;  ///< c: force of the carried directions on their master [N]
    MatX G, K;        ///< K: geometric stiffness under c, at the last evaluate_carried_stiffness
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
  std::vector<StoredTangentTerm*> stored_tangents_;  ///< of each term; null where it lacks the capability
  std::vector<PsdProjectedTerm*> projected_terms_;   ///< those that have it
  std::vector<std::shared_ptr<InertiaTerm>> inertias_;
  mutable std::vector<Driven> driven_;
  std::unique_ptr<LinearSolver> mass_solver_;
  BorderedMatrix mass_;
  std::uint64_t mass_layout_ = 0;  ///< layout version that the pattern of `mass_` was built for
  bool nodal_mass_diagonal_ = true;
  bool any_master_ = false;
  bool projects_to_psd_ = false;
  VecX nodal_mass_, inverse_nodal_mass_;
  double mean_nodal_mass_ = 0.0;
  /// of each term, whether its tangent is in the matrix that is being assembled
  std::vector<char> term_is_in_;
  std::vector<char> driven_mask_;
  std::vector<int> driven_dofs_;
  std::vector<HeldNode> driven_nodes_;
  mutable std::uint64_t driven_pattern_ = 0;  ///< version that `driven_mirrors_` was found for
  /// slot of (j, i) for each block (i, j) in the rows of the driven nodes, one after the other
  mutable std::vector<int> driven_mirrors_;
  /// hash of the layout's and the terms' pattern versions that `pattern_` was built from
  std::uint64_t pattern_key_ = 0;
  BlockSparse pattern_;
  struct TermPairs {
    bool known = false;
    std::uint64_t version = 0;
    NodePairs pairs;
  };
  std::vector<TermPairs> term_pairs_;  ///< of each term, at its version
  NodePairs mass_pairs_;
  std::uint64_t pairs_layout_ = 0;  ///< layout version that they were found for
  KeptStep kept_step_;
  mutable VecX scratch_, known_;
  VecX force_scratch_, held_scratch_, acceleration_scratch_;
};

}  // namespace palpate::dynamics
