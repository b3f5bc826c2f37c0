#pragma once
#include "contact/friction_anchors.h"
#include "contact/grasp.h"
#include "contact/resultants.h"
#include "contact/sample_math.h"
#include "contact/tangent.h"
#include "palpate/contact/contact_force.h"

namespace palpate::contact {

/// A spring of its own, whatever area it stands for; none where it faces away.
inline void count_as_point(ContactSample& sample) { sample.area = sample.area > 0.0 ? 1.0 : 0.0; }

struct ContactForce::Impl {
  struct Pair {
    std::unique_ptr<SampleSource> source;
    PressureLaw law;
    std::size_t begin = 0, end = 0;  ///< its samples
    bool follows = false;            ///< they are exact at every evaluation
    double deepest = 0.0;            ///< largest overlap that a query saw [m]
    FrictionAnchors anchors{};       ///< of what sticks
    bool given = false;  ///< frames given from outside on both sides: nothing in the State feels them
  };

  std::vector<std::shared_ptr<MovingFrame>> frames;
  std::vector<Pair> pairs;
  std::vector<PressureLaw> laws_kept;  ///< the pairs' own, while SecantTangents lives
  std::vector<ContactSample> samples, next_samples;
  std::vector<FrameState> frame_states;  ///< at the state of the evaluation under way
  std::vector<int> frame_rows;           ///< scratch
  VecX force_before, force_after;        ///< scratch of refresh
  long queries = 0;
  std::uint64_t events_version = 1;  ///< grows when a query finds other samples than the one before
  /// the last query's samples were not compared yet with those before, which are in next_samples
  bool events_to_compare = false;
  void compare_events();
  double query_seconds = 0.0;
  Resultants resultants;

  /// What a frame is to do about what presses on it, and what it does since the last refresh.
  struct Grasp {
    int frame;
    bool wanted = false, closed = false;
  };
  std::vector<Grasp> grasps;
  Bonds bonds;
  GraspCounts grasp_counts;
  /// True where one closed or let go.  @pre frames are placed
  bool take_grasps(const dynamics::StateView& state);

  /// Friction of the samples that a symmetric tangent was made of: what it leaves out is how this follows the
  /// pressure until the next.
  struct Linearised {
    std::size_t sample, pair;
    double pressure;    ///< [Pa]
    Vec3 per_pressure;  ///< [m^2]
  };
  std::vector<Linearised> linearised;
  double largest_friction_lag = 0.0, largest_friction = 0.0;  ///< [N]
  void linearise_friction(const dynamics::StateView& state);
  void measure_friction_lag(const dynamics::StateView& state);
  /// Friction within a step, where it is that of the step's end.
  struct StepFriction {
    bool on = false;
    int solves = 0;
    std::vector<FrictionGuess> guesses;    ///< by sample
    double left_out = 0.0, largest = 0.0;  ///< of the last solve, of the pairs' sums [N]
  } step_friction;
  bool has_step_friction(const PressureLaw& law) const {
    return step_friction.on && law.secant_friction && law.friction > 0.0;
  }
  FrictionLine line_of(const ContactSample& s) const {
    return friction_line(step_friction.guesses[static_cast<std::size_t>(&s - samples.data())], s.normal);
  }
  /// ContactForce::improve_step.
  bool improve_friction(const dynamics::StateView& state, const VecX& moved, const VecX& change,
                        const FrameStep& given, double tolerance);
  std::vector<FrictionError> friction_errors;  ///< scratch: by pair
  /// As the pair's law has it, or within a step as that takes it.
  Vec3 force_of(const ContactSample& s, const SampleMotion& motion, const PressureLaw& law) const {
    return has_step_friction(law) ? sample_force_and_tangent(s, motion, law, line_of(s)).force
                                  : sample_force(s, motion, law);
  }
  SampleForce tangent_of(const ContactSample& s, const SampleMotion& motion, const PressureLaw& law,
                         bool symmetric) const {
    return has_step_friction(law) ? sample_force_and_tangent(s, motion, law, line_of(s))
                                  : sample_force_and_tangent(s, motion, law, symmetric);
  }
  /// Frames, and with them the samples that follow, at the state of an evaluation.
  void place_frames(const dynamics::StateView& state);
  void place_frames_alone(const dynamics::StateView& state);
  void follow(const dynamics::StateView& state);
  bool has_followers() const;  ///< whether a pair's samples follow the state
  void note_followed(const dynamics::StateView& state);
  /// What the samples that follow depend on, as it was when they were last evaluated.
  struct Followed {
    long query = -1;
    double time = 0.0;
    VecX q;
    std::vector<Pose> poses;
  } followed;
  void query(const dynamics::StateView& state);
  void measure_depth(Pair& pair) const;  ///< of its next samples
  void check_samples(const dynamics::StateView& state) const;
  const std::vector<int>& rows_of_frames();  ///< in the State
  /// @pre frames are placed
  void add_forces(const dynamics::StateView& state, VecX& f);
  void apply_tangents(const dynamics::StateView& state, double k_scale, double d_scale, const VecX& x,
                      VecX& y);
  /// Forces on the nodes and on every frame (six rows each, given ones too): what a refresh must not change
  /// unseen.
  /// @param on_a  one entry a pair: its resultant is added
  void all_forces(const dynamics::StateView& state, VecX& f, std::vector<Wrench>& on_a);

  void find_given();  ///< Pair::given
  VecX product;       ///< scratch of a step

  /// Whether its samples open and close with a kink that the State feels.
  static bool has_events(const Pair& pair) {
    return pair.law.onset == 0.0 && !pair.given && pair.source->has_events();
  }
  enum class Which {
    kEvery,
    kOfState  ///< each that acts on the State
  };
  /// visit(sample, motion, law) for each sample in penetration, in order.  @pre frames are placed
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
