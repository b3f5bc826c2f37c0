#pragma once
#include "contact/friction_anchors.h"
#include "contact/grasp.h"
#include "contact/resultants.h"
#include "contact/sample_math.h"
#include "contact/tangent.h"
#include "palpate/contact/contact_force.h"

namespace palpate::contact {

/// Turns one sample into a spring per point, independent of its area; without a spring where the vertex faces
/// away.
inline void count_as_point(ContactSample& sample) { sample.area = sample.area > 0.0 ? 1.0 : 0.0; }

/// State and helpers of ContactForce.
struct ContactForce::Impl {
  struct Pair {
    std::unique_ptr<SampleSource> source;
    PressureLaw law;
    std::size_t begin = 0, end = 0;  ///< Range of its samples.
    bool follows = false;            ///< Samples are re-evaluated at every state (SourceTraits::follows).
    double deepest = 0.0;            ///< Largest overlap found by a query [m].
    FrictionAnchors anchors{};       ///< Anchors of sticking contacts.
    bool given = false;              ///< Prescribed frames on both sides: no effect on the State.
  };

  std::vector<std::shared_ptr<MovingFrame>> frames;
  std::vector<Pair> pairs;
  std::vector<PressureLaw> laws_kept;  ///< Laws of the pairs, saved during use_secant_tangents().
  std::vector<ContactSample> samples, next_samples;
  std::vector<FrameState> frame_states;  ///< Frames at the state of the present evaluation.
  std::vector<int> frame_rows;           ///< Scratch.
  VecX force_before, force_after;        ///< Scratch of refresh().
  std::uint64_t events_version = 1;  ///< Increases when a query finds other samples than the previous one.
  /// True: the samples of the last query were not compared yet with the previous ones, which are in
  /// next_samples.
  bool events_to_compare = false;
  void compare_events();
  ContactStatistics statistics;
  Resultants resultants;

  /// Requested and actual state of a frame's grasp; the actual state changes at a refresh.
  struct Grasp {
    int frame;
    bool requested = false, closed = false;
  };
  std::vector<Grasp> grasps;
  Bonds bonds;
  /// Applies grasp commands. Returns true where points were held or released. @pre frames are placed
  bool take_grasps(const dynamics::StateView& state);

  /// Friction of a sample for which a symmetric tangent was computed. The tangent neglects how this friction
  /// follows the pressure until the next tangent.
  struct Linearised {
    std::size_t sample, pair;
    double pressure;    ///< Pressure [Pa].
    Vec3 per_pressure;  ///< Friction per pressure [m^2].
  };
  std::vector<Linearised> linearised;
  void linearise_friction(const dynamics::StateView& state);
  void measure_friction_lag(const dynamics::StateView& state);
  /// State of friction within a step for which it is evaluated at the step's end.
  struct StepFriction {
    bool on = false;
    int solves = 0;
    std::vector<FrictionGuess> guesses;    ///< Guess per sample.
    double left_out = 0.0, largest = 0.0;  ///< Sums over pairs in the last solve [N].
  } step_friction;
  bool has_step_friction(const PressureLaw& law) const {
    return step_friction.on && law.secant_friction && law.friction > 0.0;
  }
  FrictionLine line_of(const ContactSample& s) const {
    return friction_line(step_friction.guesses[static_cast<std::size_t>(&s - samples.data())], s.normal);
  }
  /// Implements ContactForce::improve_step.
  bool improve_friction(const dynamics::StateView& state, const VecX& moved, const VecX& change,
                        const FrameStep& given, double tolerance);
  std::vector<FrictionError> friction_errors;  ///< Scratch, per pair.
  /// Returns the force of a sample by the pair's law or, within a step, by the affine friction of the step.
  Vec3 force_of(const ContactSample& s, const SampleMotion& motion, const PressureLaw& law) const {
    return has_step_friction(law) ? sample_force_and_tangent(s, motion, law, line_of(s)).force
                                  : sample_force(s, motion, law);
  }
  SampleForce tangent_of(const ContactSample& s, const SampleMotion& motion, const PressureLaw& law,
                         bool symmetric) const {
    return has_step_friction(law) ? sample_force_and_tangent(s, motion, law, line_of(s))
                                  : sample_force_and_tangent(s, motion, law, symmetric);
  }
  /// Evaluates the frames, and the samples that follow, at a state.
  void place_frames(const dynamics::StateView& state);
  void place_frames_alone(const dynamics::StateView& state);
  void follow(const dynamics::StateView& state);
  bool has_followers() const;  ///< Returns whether the samples of any pair follow the state.
  void note_followed(const dynamics::StateView& state, bool by_query);
  bool is_followed(const dynamics::StateView& state) const;
  /// Inputs of the samples that follow, as of their last evaluation.
  struct Followed {
    long query = -1;
    bool by_query = false;  ///< The samples are those of the query.
    double time = 0.0;
    VecX q;
    std::vector<Pose> poses;
  } followed;
  void query(const dynamics::StateView& state);
  void measure_depth(Pair& pair) const;  ///< Evaluates its next samples.
  void check_samples(const dynamics::StateView& state) const;
  const std::vector<int>& rows_of_frames();  ///< Rows of the frames in the State.
  /// @pre frames are placed
  void add_forces(const dynamics::StateView& state, VecX& f);
  void apply_tangents(const dynamics::StateView& state, double k_scale, double d_scale, const VecX& x,
                      VecX& y);
  /// Computes the forces on the nodes and on every frame (six rows each, prescribed frames included), for
  /// comparison before and after a refresh.
  /// @param on_a  resultants on side a, to which those of the samples are added; one entry per pair
  void all_forces(const dynamics::StateView& state, VecX& f, std::vector<Wrench>& on_a);

  void find_given();  ///< Sets Pair::given.
  VecX product;       ///< Scratch of a step.

  /// Returns whether the samples of a pair open and close with a kink that affects the State.
  static bool has_events(const Pair& pair) {
    return pair.law.onset == 0.0 && !pair.given && pair.source->traits().has_events;
  }
  enum class Which {
    kEvery,
    kOfState  ///< Samples that act on the State.
  };
  /// Calls visit(sample, motion, law) for each sample in penetration, in order. @pre frames are placed
  template <class Visit>
  void visit_active(const dynamics::StateView& state, Which which, const Visit& visit) {
    for (const Pair& pair : pairs) {
      if (which == Which::kOfState && pair.given) continue;
      for (std::size_t i = pair.begin; i < pair.end; ++i) {
        const SampleMotion motion = sample_motion(samples[i], state, frame_states);
        if (motion.gap < 0.0) visit(samples[i], motion, pair.law);
      }
    }
  }
};

}  // namespace palpate::contact
