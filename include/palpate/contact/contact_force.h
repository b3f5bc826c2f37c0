#pragma once
#include <memory>
#include <string_view>
#include <vector>

#include "palpate/contact/frame.h"
#include "palpate/contact/frame_linearisation.h"
#include "palpate/contact/query_view.h"
#include "palpate/contact/sample_source.h"
#include "palpate/contact/spec.h"
#include "palpate/contact/statistics.h"
#include "palpate/contact/tie.h"
#include "palpate/core/archive.h"
#include "palpate/dynamics/force_term.h"
#include "palpate/dynamics/repeated_step.h"
#include "palpate/dynamics/step_assembly.h"

namespace palpate::contact {

struct ReducedSample;  // reduced_contact_model.h
struct ReducedTangent;

/// Motion, within a step, of a frame that is not part of the State.
struct FrameStep {
  int frame = -1;              ///< Index returned by add_frame(); -1: no frame moves.
  Vec6 moved = Vec6::Zero();   ///< Rotation vector and displacement [rad, m].
  Vec6 change = Vec6::Zero();  ///< Change of the twist [rad/s, m/s].
};

/// All contacts of a scene as one force term (docs/theory/contact.md).
class ContactForce : public dynamics::ForceTerm,
                     public dynamics::PointStiffnessTerm,
                     public dynamics::RepeatedStepTerm {
 public:
  ContactForce();
  ~ContactForce() override;
  int add_frame(std::shared_ptr<MovingFrame> frame);  ///< Returns the index for SurfacePoint::frame.
  /// Adds one [[contact]]: the source of its samples and the law of their pressure. @return its index
  int add_pair(std::unique_ptr<SampleSource> source, const ContactSpec& law);

  std::string_view name() const override;
  dynamics::TermTraits traits() const override;
  void add_pattern(dynamics::PatternBuilder& pattern) const override;
  std::uint64_t pattern_version() const override;
  void add_force(const dynamics::StateView& state, VecX& f) override;
  void add_tangent(const dynamics::StateView& state, double k_scale, double d_scale,
                   dynamics::BorderedMatrix& A) override;
  void apply_tangent(const dynamics::StateView& state, double k_scale, double d_scale, const VecX& x,
                     VecX& y) override;
  bool is_point_stiffness() const override;
  void add_step(const dynamics::StateView& state, const VecX& shift, double k_scale, double d_scale, VecX& f,
                dynamics::PointStiffness& C, dynamics::SparseBorder& border) override;
  void add_step_force(const dynamics::StateView& state, const VecX& shift, const VecX& change,
                      VecX& f) override;
  /// The following three functions concern pairs with friction_tangent = "secant": within a step their
  /// friction is evaluated at the end of the step (friction.h).
  bool has_onset_at(const dynamics::StateView& state) override;
  bool begin_step(const dynamics::StateView& state) override;
  bool improve_step(const dynamics::StateView& state, const VecX& moved, const VecX& change) override;
  /// Improves the friction guess for a pressing frame that moves and is not part of the State; all other
  /// friction keeps the value at the start of the step.
  /// @param state  start of the step  @param moved  displacement along u-directions [m, rad]
  /// @param change  change of u [m/s, rad/s]  @param given  motion of that frame
  /// @param tolerance  accepted relative difference of the friction from the law; 0: the default of a step
  ///   (friction.h)
  bool improve_step(const dynamics::StateView& state, const VecX& moved, const VecX& change,
                    const FrameStep& given, double tolerance = 0.0);
  void end_step() override;
  double energy(const dynamics::StateView& state) override;
  double dissipated_power(const dynamics::StateView& state) override;
  bool refresh(const dynamics::StateView& state) override;
  /// One root function for each sample whose pressure sets in with a kink (onset_width_m = 0): negative while
  /// the sample presses, positive while it does not, and zero exactly where it opens or closes. Because the
  /// damper is cut off during separation, that is not where the gap closes: see pressing() in pressure.cpp.
  /// The number of functions is constant between two refreshes. A refresh may change it, even one that
  /// changes no force and returns false.
  int event_count() const override;
  std::uint64_t events_version() const override;
  void events(const dynamics::StateView& state, double* g) override;

  /// Closes or opens the grasp of a frame, effective at the next refresh. A closed grasp holds the points of
  /// nodes that press on the frame at that refresh, in addition to their contact: against separation and
  /// along the surface (src/contact/grasp.cpp). Points that come into contact later are not held. Opening
  /// releases all points.
  void set_grasp(int frame, bool closed);
  /// Ties nodes to a frame permanently (src/contact/grasp.cpp).
  void tie(int frame, const std::vector<Tie>& ties);
  /// Returns the samples of the last query, candidates included.
  const std::vector<ContactSample>& samples() const;
  /// Returns the contact wrench on a frame, about its origin, in world axes [N m, N].
  Wrench frame_wrench(const dynamics::StateView& state, int frame) const;
  /// Linearises the contact of a frame at a state; `out` is resized.
  void linearise(const dynamics::StateView& state, int frame, FrameLinearisation& out,
                 Partners partners = Partners::kAll) const;
  /// Returns the samples of a frame on nodes at the given state, including candidates that are not in
  /// contact.
  /// @param state  state at which the gaps are evaluated  @param frame  index returned by add_frame()
  /// @param tangents  receives the tangent of each sample; null: not computed
  std::vector<ReducedSample> reduced_samples(const dynamics::StateView& state, int frame,
                                             std::vector<ReducedTangent>* tangents = nullptr) const;
  /// Returns the statistics of all contacts since the start.
  const ContactStatistics& statistics() const;
  /// Returns the report of each pair, in the order of add_pair(). Its pointers are valid as long as this
  /// object.
  std::vector<PairReport> pairs() const;
  /// Returns the number of pairs.
  std::size_t pair_count() const;
  /// Returns PairReport::deepest of one pair.
  double deepest(std::size_t pair) const;
  /// Makes every source keep the data that pictures need, from the next query on.
  void keep_views();
  /// Returns all samples of the last query that have an area, candidates included, evaluated at the given
  /// state.
  std::vector<ContactPoint> points(const dynamics::StateView& state) const;
  /// Makes all pairs use the tangents of friction_tangent = "secant", whatever their setting: symmetric, as
  /// the tool's steps need them. These tangents do not count in ContactStatistics::largest_friction_lag.
  /// @param on  false: restores the settings  @pre the opposite of the present state
  void use_secant_tangents(bool on);
  /// Saves or restores the state of a checkpoint: held points, data that queries take from earlier ones, and
  /// counters. Samples are not saved; they are recomputed by a query when the checkpoint is restored.
  /// @param a  archive that saves or restores  @param state  current state
  void archive(Archive& a, const dynamics::StateView& state);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Scope guard of ContactForce::use_secant_tangents().
class SecantTangents {
 public:
  /// @param contact  must outlive this object
  explicit SecantTangents(ContactForce& contact) : contact_(contact) { contact_.use_secant_tangents(true); }
  ~SecantTangents() { contact_.use_secant_tangents(false); }
  SecantTangents(const SecantTangents&) = delete;
  SecantTangents& operator=(const SecantTangents&) = delete;

 private:
  ContactForce& contact_;
};

}  // namespace palpate::contact
