#pragma once
#include <cstdint>
#include <string_view>

#include "palpate/dynamics/matrix.h"
#include "palpate/dynamics/state.h"

namespace palpate::dynamics {

/// Properties of a force term, for integrators that split the right-hand side (ImEx, multi-rate) or choose a
/// linear solver.
struct TermTraits {
  bool stiff = true;              ///< Belongs on the implicit side of a split.
  bool fast = false;              ///< Belongs on the fast side of a multi-rate split.
  bool symmetric_tangent = true;  ///< false: the step matrix needs an unsymmetric solver.
  /// false: for explicit use only (gravity and other dead loads have a zero tangent and set true).
  bool has_tangent = true;
  bool conservative = false;  ///< energy() is its potential.
  /// Kinked where it opens and closes; an ImEx split may put it on the explicit side.
  bool contact = false;
  bool zero_tangent = false;  ///< Its tangent is zero: a dead load.
};

/// Diagnosis of a state at which a step failed: an inverted element.
struct Diagnostic {
  int element = -1;      ///< Element, in the term's numbering; -1: nothing found.
  double measure = 0.0;  ///< det F of the element.
};

/// One summand of the forces in M u' = sum of f: force, tangent and energy of a soft body, of contact, of
/// gravity.
/// Sizes: f and u have layout.u_size entries; K = -df/dq N(q) (derivative along u-directions) and D = -df/du
/// are u_size x u_size. Evaluation does not change the model, but uses scratch memory of the object: one
/// object must not be called from two threads at once. Abilities that only some terms have are optional
/// capability classes, which a term inherits in addition to this class: stored_tangent.h, psd_projection.h,
/// step_assembly.h, repeated_step.h.
class ForceTerm {
 public:
  virtual ~ForceTerm() = default;
  /// Returns the name for messages and traces.
  virtual std::string_view name() const = 0;
  /// Returns the properties of the term. Read when the term is added to a System, and constant from then on,
  /// except for symmetric_tangent.
  virtual TermTraits traits() const = 0;

  /// Adds the node pairs that add_tangent may touch. Called again when pattern_version() has increased.
  virtual void add_pattern(PatternBuilder&) const {}
  /// Increases whenever add_pattern() would add other pairs.
  virtual std::uint64_t pattern_version() const { return 0; }

  /// Adds the force at this state, f += force [N, N m].
  virtual void add_force(const StateView& state, VecX& f) = 0;
  /// Adds the tangent, A += k_scale K + d_scale D, into body, right, bottom and corner.
  virtual void add_tangent(const StateView& state, double k_scale, double d_scale, BorderedMatrix& A) = 0;
  /// Adds the product y += (k_scale K + d_scale D) x without assembly; x and y have u_size entries.
  virtual void apply_tangent(const StateView& state, double k_scale, double d_scale, const VecX& x,
                             VecX& y) = 0;
  /// Returns the potential energy [J]; zero where there is none.
  virtual double energy(const StateView&) { return 0.0; }
  /// Returns the power dissipated by damping and friction, >= 0 [W]; zero where there is none.
  virtual double dissipated_power(const StateView&) { return 0.0; }

  /// Updates the slow part (a contact query). Called by the loop every `contact_refresh_s`, never by an
  /// integrator. Returns true when this changed the force (multistep methods then restart).
  virtual bool refresh(const StateView&) { return false; }

  /// Returns the worst defect of this term at a state (an inverted element); for traces, not used by the
  /// step.
  virtual Diagnostic inspect(const StateView&) const { return {}; }
  /// Returns the number of tangent contributions (elements) so far that were bounded near a singularity of
  /// their law.
  virtual long clamped_tangents() const { return 0; }

  /// Returns the number of root functions for event location: g changes sign at an event (a gap closing).
  virtual int event_count() const { return 0; }
  /// Increases whenever event_count() or the meaning of one of the functions changed: a root finder then
  /// compares no old value with a new one.
  virtual std::uint64_t events_version() const { return 0; }
  /// Evaluates the root functions; g receives event_count() values.
  virtual void events(const StateView&, double* /*g*/) {}
};

}  // namespace palpate::dynamics
