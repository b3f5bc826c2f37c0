#pragma once
#include <cstdint>
#include <string_view>

#include "palpate/dynamics/matrix.h"
#include "palpate/dynamics/state.h"

namespace palpate::dynamics {

/// What a term is, for the integrators that split the right-hand side (ImEx, multi-rate) or choose a solver.
struct TermTraits {
  bool stiff = true;              ///< belongs on the implicit side of a split
  bool fast = false;              ///< belongs on the fast side of a multi-rate split
  bool symmetric_tangent = true;  ///< false: the step matrix needs an unsymmetric solver
  /// false: explicit only (gravity and other dead loads have a zero tangent and say true)
  bool has_tangent = true;
  bool conservative = false;  ///< energy() is its potential
  /// kinked where it opens and closes; an ImEx split may put it on the explicit side
  bool contact = false;
  bool zero_tangent = false;  ///< its tangent is zero: a dead load
};

/// A term's diagnosis of a state that a step failed at: an inverted element.
struct Diagnostic {
  int element = -1;      ///< in the term's own numbering; -1: nothing found
  double measure = 0.0;  ///< det F of an element
};

/// One sum in M u' = sum of f.  Force, tangent and energy of a soft body, of contact, of gravity.
/// Sizes: f and u are layout.u_size; K = -df/dq N(q) (derivative along u-directions) and D = -df/du, both
/// u_size x u_size. Evaluation is const on the model: scratch memory belongs to the object, so one object is
/// not called from two threads at once.  What only some terms can do is a capability that a term derives from
/// beside this class: stored_tangent.h, psd_projection.h, step_assembly.h.
class ForceTerm {
 public:
  virtual ~ForceTerm() = default;
  /// What messages and traces call it.
  virtual std::string_view name() const = 0;
  /// Read when the term is added to a System, and constant from then on but for symmetric_tangent.
  virtual TermTraits traits() const = 0;

  /// Node pairs that add_tangent may touch.  Called again when pattern_version() has grown.
  virtual void add_pattern(PatternBuilder&) const {}
  /// Grows whenever add_pattern() would add other pairs.
  virtual std::uint64_t pattern_version() const { return 0; }

  /// f += force at this state [N, N m]
  virtual void add_force(const StateView& state, VecX& f) = 0;
  /// A += k_scale K + d_scale D, added into body, right, bottom and corner.
  virtual void add_tangent(const StateView& state, double k_scale, double d_scale, BorderedMatrix& A) = 0;
  /// y += (k_scale K + d_scale D) x without assembling; x and y of u_size.
  virtual void apply_tangent(const StateView& state, double k_scale, double d_scale, const VecX& x,
                             VecX& y) = 0;
  /// Potential energy [J]; zero where there is none.
  virtual double energy(const StateView&) { return 0.0; }
  /// Power taken out by damping and friction, >= 0 [W]; zero where there is none.
  virtual double dissipated_power(const StateView&) { return 0.0; }

  /// The slow part (a contact query).  Called by the loop at `contact_refresh_s`, never by an integrator;
  /// returns true when the force changed by it (multistep methods then restart).
  virtual bool refresh(const StateView&) { return false; }

  /// The worst of what can go wrong in this term at a state; for traces, not for the step.
  virtual Diagnostic inspect(const StateView&) const { return {}; }
  /// Parts of its tangents (elements) that were bounded near a singularity of their law, over all so far.
  virtual long clamped_tangents() const { return 0; }

  /// Root functions for event location: g changes sign at an event (a gap closing).
  virtual int event_count() const { return 0; }
  /// Grows whenever event_count() or the meaning of one of the functions changed: a root finder then
  /// compares no old value with a new one.
  virtual std::uint64_t events_version() const { return 0; }
  /// g receives event_count() values.
  virtual void events(const StateView&, double* /*g*/) {}
};

}  // namespace palpate::dynamics
