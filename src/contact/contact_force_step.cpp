// Friction over a step, evaluated at its end by repeated solves (friction.cpp).
#include <algorithm>

#include "contact/contact_force_impl.h"

namespace palpate::contact {
namespace {

/// Returns the motion of a point with its frame, for displacements along u-directions. The rotation of a
/// frame with constant twist also changes the point's velocity (V of tangent.h).
SampleStep of_frame(const PointMotion& motion, const FrameState& frame, const Vec6& moved,
                    const Vec6& change) {
  const Vec3 turn = moved.head<3>();
  return {turn.cross(motion.arm) + moved.tail<3>(),
          change.head<3>().cross(motion.arm) + change.tail<3>() +
              frame.twist.angular.cross(turn.cross(motion.rotating))};
}

SampleStep of_state(const SurfacePoint& point, const PointMotion& motion,
                    const std::vector<FrameState>& frames, const VecX& moved, const VecX& change) {
  SampleStep out;
  if (point.frame >= 0) {
    const FrameState& frame = frames[static_cast<std::size_t>(point.frame)];
    if (frame.u_offset < 0) return out;
    return of_frame(motion, frame, moved.segment<6>(frame.u_offset), change.segment<6>(frame.u_offset));
  }
  for (int i = 0; i < point.count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    out.moved += point.weight[k] * moved.segment<3>(3 * point.node[k]);
    out.change += point.weight[k] * change.segment<3>(3 * point.node[k]);
  }
  return out;
}

}  // namespace

bool ContactForce::has_onset_at(const dynamics::StateView& state) {
  Impl& m = *impl_;
  m.place_frames(state);
  bool sticks = false;
  m.visit_active(state, Impl::Which::kEvery,
                 [&](const ContactSample& s, const SampleMotion& motion, const PressureLaw& law) {
                   const Impl::Pair& pair = m.pairs[static_cast<std::size_t>(s.source)];
                   sticks = sticks || (!pair.given && law.friction > 0.0 &&
                                       sliding_velocity(s, motion).norm() <= law.regularisation);
                 });
  return sticks;
}

bool ContactForce::begin_step(const dynamics::StateView& state) {
  Impl& m = *impl_;
  m.step_friction.on = std::any_of(m.pairs.begin(), m.pairs.end(), [](const Impl::Pair& pair) {
    return pair.law.secant_friction && pair.law.friction > 0.0 && pair.begin < pair.end;
  });
  if (!m.step_friction.on) return false;
  m.step_friction.solves = 0;
  m.place_frames(state);
  bool any = false;
  m.step_friction.guesses.assign(m.samples.size(), {});
  m.visit_active(state, Impl::Which::kEvery,
                 [&](const ContactSample& s, const SampleMotion& motion, const PressureLaw& law) {
                   if (!m.has_step_friction(law)) return;
                   any = true;
                   const SampleEnd start = sample_end(s, motion, law, {});
                   m.step_friction.guesses[static_cast<std::size_t>(&s - m.samples.data())] =
                       first_guess(start.limit, start.v, law.regularisation);
                 });
  m.step_friction.on = any;
  return any;
}

bool ContactForce::improve_step(const dynamics::StateView& state, const VecX& moved, const VecX& change) {
  return improve_step(state, moved, change, {});
}

bool ContactForce::improve_step(const dynamics::StateView& state, const VecX& moved, const VecX& change,
                                const FrameStep& given, double tolerance) {
  return impl_->improve_friction(state, moved, change, given,
                                 tolerance > 0.0 ? tolerance : kFrictionTolerance);
}

/// The error is measured per pair: a heavy body in the same step does not hide the error of a light one.
bool ContactForce::Impl::improve_friction(const dynamics::StateView& state, const VecX& moved,
                                          const VecX& change, const FrameStep& given, double tolerance) {
  Impl& m = *this;
  m.place_frames(state);
  const auto step_of = [&](const SurfacePoint& point, const PointMotion& motion) {
    return point.frame >= 0 && point.frame == given.frame
               ? of_frame(motion, m.frame_states[static_cast<std::size_t>(given.frame)], given.moved,
                          given.change)
               : of_state(point, motion, m.frame_states, moved, change);
  };
  StepFriction& step = m.step_friction;
  ++step.solves;
  step.left_out = step.largest = 0.0;
  m.friction_errors.assign(m.pairs.size(), {});
  double worst = 0.0;
  for (std::size_t p = 0; p < m.pairs.size(); ++p) {
    const Impl::Pair& pair = m.pairs[p];
    if (!m.has_step_friction(pair.law)) continue;
    FrictionError& error = m.friction_errors[p];
    for (std::size_t i = pair.begin; i < pair.end; ++i) {
      const ContactSample& s = m.samples[i];
      // The same holds for all samples of a pair.
      const bool elsewhere = s.a.frame != given.frame && s.b.frame != given.frame;
      if (given.frame >= 0 && elsewhere) break;
      const SampleMotion motion = sample_motion(s, state, m.frame_states);
      if (motion.gap >= 0.0) continue;
      const SampleStep a = step_of(s.a, motion.a), b = step_of(s.b, motion.b);
      const SampleEnd end = sample_end(s, motion, pair.law, {a.moved - b.moved, a.change - b.change});
      FrictionGuess& guess = step.guesses[i];
      const FrictionLine line = friction_line(guess, s.normal);
      const Vec3 taken = line.constant - line.D * end.v;
      error.add(taken, end.limit, end.v, pair.law.regularisation);
      end_solve(guess, end.limit, end.v, taken);
    }
    worst = std::max(worst, error.relative());
    if (pair.given) continue;
    step.left_out = std::max(step.left_out, error.left_out.norm());
    step.largest = std::max(step.largest, error.friction.norm());
  }
  if (worst <= tolerance || step.solves >= kFrictionSolves) return true;
  move_guesses(step.guesses, step.solves);
  return false;
}

void ContactForce::end_step() {
  Impl& m = *impl_;
  m.step_friction.on = false;
  if (!m.laws_kept.empty()) return;
  ContactStatistics& all = m.statistics;
  all.largest_lagged_friction = std::max(all.largest_lagged_friction, m.step_friction.largest);
  all.largest_friction_lag = std::max(all.largest_friction_lag, m.step_friction.left_out);
}

}  // namespace palpate::contact
