#include <cmath>

#include "core/clock.h"
#include "palpate/tool/tool.h"
#include "scene_run.h"

// The tool alone under its virtual coupling (m, I; k, b; k_r, b_r), with every integrator of its ticks of
// h = 1 ms.
//
// Thrown: the handle jumps by d = 1 m at one tick and remains there. The coupling then stores 1/2 k d^2 and
// is passive: the tool is never farther from the handle than d, and slower than d sqrt(k/m). Stable: within
// both, to 1 %. Bounded: ten times. And it must arrive: an oscillator with w = sqrt(k/m), s = b/(2 m) < w is
// within d e^(-s T)/sqrt(1 - (s/w)^2) after T; twice this covers the damping added by ticks of w h = 0.05.
//
// Spun: the handle rotates at W = 1000 rad/s, one radian per tick, about one axis. The moment is at most
//     k_r pi + b_r (W - w):
// the tool is braked as soon as b_r (w - W) > k_r pi, so w <= W + k_r pi/b_r. Stable: within it, to 1 %.
// Bounded: ten times. The ticks resolve the handle's angle only modulo 2 pi: the direction in which the
// spring pulls is arbitrary, and the bound holds for either. The tool must be carried along: I w' >= b_r (W -
// w) - k_r pi brings it to w >= W - k_r pi/b_r at the rate b_r/I, 12 time constants in the 50 ticks; 9/10 of
// this is required.
//
// An explicit scheme has a limit, which is satisfied here (k h^2/m = 3e-3, b h/m = 0.02, k_r h^2/I = 0.08,
// b_r h/I = 0.25, all well below 2). So for all schemes:
//   -> stable, bounded
//
// A million ticks, with handle and tool at rest at the same place: the coupling's wrench is zero to rounding
// and its damper dissipates the energy due to rounding; drift below 1e-12 m and rad, and memory does not
// grow.
//   -> accurate
// With the tool also pulled by a constant contact force F, it rests at the distance F/k, to 1e-9 F/k.
//   -> accurate

namespace palpate::stability {

namespace {

constexpr double kTick = 1e-3;

ToolSpec tool_spec(const CaseContext& context) {
  ToolSpec spec;
  spec.integrator = context.column.name;
  spec.coupling.rotational_damping_n_m_s_rad = 1e-3;
  return spec;
}

struct Motion {
  dynamics::StepResult result;
  bool finite = true, interrupted = false;
  double distance = 0.0, speed = 0.0, spin = 0.0;  ///< Largest, from the handle's last position.
  double last_distance = 0.0, last_spin = 0.0;
};

/// Moves the tool with the handle; `handle(i)` returns pose and twist at the end of tick i.
Motion move(const CaseContext& context, tool::Tool& tool, int ticks,
            const std::function<std::pair<Pose, Twist>(int)>& handle) {
  Motion motion;
  for (int i = 0; i < ticks; ++i) {
    if (context.time_is_up()) {
      motion.interrupted = true;
      break;
    }
    const auto [pose0, twist0] = handle(i);
    const auto [pose1, twist1] = handle(i + 1);
    motion.result = tool.advance(kTick, {pose0, pose1, twist0, twist1}, {});
    if (!motion.result.ok()) break;
    const Vec3 away = tool.pose().translation - pose1.translation;
    motion.finite = away.allFinite() && tool.twist().angular.allFinite();
    if (!motion.finite) break;
    motion.last_distance = away.norm();
    motion.last_spin = tool.twist().angular.norm();
    motion.distance = std::max(motion.distance, away.norm());
    motion.speed = std::max(motion.speed, tool.twist().linear.norm());
    motion.spin = std::max(motion.spin, tool.twist().angular.norm());
  }
  return motion;
}

/// Returns the verdict for a ratio of motion to its bound.
/// @param follows whether the tool followed the handle as required
StabilityCell judge_ratio(const CaseContext& context, const Motion& motion, double ratio, bool follows,
                          const char* what) {
  StabilityCell cell;
  cell.gain = ratio - 1.0;
  cell.figure = fmt::format("{} {:.3f} of the maximum that the coupling can supply", what, ratio);
  if (ended_early(context.column, motion.result, motion.finite, motion.interrupted, ratio > 10.0, cell))
    return cell;
  cell.verdict = ratio <= 1.01 ? Verdict::kStable : ratio <= 10.0 ? Verdict::kBounded : Verdict::kGrew;
  if (follows || ratio > 10.0) return cell;
  cell.verdict = Verdict::kWrong;
  cell.reason = "the tool does not follow its handle";
  return cell;
}

StabilityCell thrown(const CaseContext& context) {
  const ToolSpec spec = tool_spec(context);
  tool::Tool tool(spec, Vec3::Zero());
  const Motion motion = move(context, tool, 300, [](int i) {
    return std::pair{Pose{Quat::Identity(), i < 10 ? Vec3(0, 0, 0) : Vec3(1, 0, 0)}, Twist{}};
  });
  const double fastest = std::sqrt(spec.coupling.stiffness_n_m / spec.mass_kg),
               s = 0.5 * spec.coupling.damping_n_s_m / spec.mass_kg,
               left = 2.0 * std::exp(-s * 0.29) / std::sqrt(1.0 - std::pow(s / fastest, 2));
  return judge_ratio(context, motion, std::max(motion.distance, motion.speed / fastest),
                     motion.last_distance <= left, "distance and speed");
}

StabilityCell spun(const CaseContext& context, int ticks) {
  constexpr double kSpin = 1000.0;
  const ToolSpec spec = tool_spec(context);
  tool::Tool tool(spec, Vec3::Zero());
  const Vec3 axis = Vec3(1, -2, 0.5).normalized();
  const Motion motion = move(context, tool, ticks, [&](int i) {
    return std::pair{Pose{quaternion_of(std::remainder(kSpin * kTick * i, 2.0 * M_PI) * axis), Vec3::Zero()},
                     Twist{kSpin * axis, Vec3::Zero()}};
  });
  const double by_spring =
      spec.coupling.rotational_stiffness_n_m_rad * M_PI / spec.coupling.rotational_damping_n_m_s_rad;
  return judge_ratio(context, motion, motion.spin / (kSpin + by_spring),
                     motion.last_spin >= 0.9 * (kSpin - by_spring), "spin");
}

/// Measures the largest distance from the rest position over a million ticks, after the first ten thousand.
StabilityCell million(const CaseContext& context, double force) {
  constexpr int kTicks = 1000000, kSettling = 10000;
  const ToolSpec spec = tool_spec(context);
  tool::Tool tool(spec, Vec3::Zero());
  dynamics::LinearisedContact pull;
  pull.version = 1;
  pull.source = dynamics::LinearisedContact::Source::kFrozen;
  pull.F0[3] = force;
  const Vec3 rest(force / spec.coupling.stiffness_n_m, 0, 0);
  StabilityCell cell;
  dynamics::StepResult result;
  double drift = 0.0, rotation = 0.0, memory = 0.0;
  bool interrupted = false;
  for (int i = 0; i < kTicks && result.ok() && !interrupted; ++i) {
    if (i == kSettling) memory = resident_memory_mib();
    result = tool.advance(kTick, {}, pull);
    interrupted = context.time_is_up();
    if (i < kSettling) continue;
    drift = std::max(drift, (tool.pose().translation - rest).norm());
    rotation = std::max(rotation, rotation_vector(tool.pose().rotation).norm());
  }
  const double grown = resident_memory_mib() - memory, bar = force > 0.0 ? 1e-9 * rest.norm() : 1e-12;
  cell.steps = kTicks;
  cell.error = drift;
  cell.figure = fmt::format("drift {:.1e} m (limit {:.0e}), {:.1e} rad, memory {:+.1f} MiB", drift, bar,
                            rotation, grown);
  if (ended_early(context.column, result, std::isfinite(drift + rotation), interrupted, false, cell))
    return cell;
  cell.verdict = drift <= bar && rotation <= 1e-12 && grown < 1.0 ? Verdict::kAccurate : Verdict::kGrew;
  return cell;
}

Verdicts passive(const CaseContext&) { return {Verdict::kStable, Verdict::kBounded}; }
Verdicts accurate(const CaseContext&) { return {Verdict::kAccurate}; }

}  // namespace

Row thrown_handle_row() {
  if (!tool::available())
    return {"thrown-handle", "requires tools, which were not compiled in", RowColumns::kTools};
  return {
      "thrown-handle",
      "a handle that jumps by 1 m, or spins at 1000 rad/s, and the ticks of the tool.  Detects ticks that "
      "produce energy, and tools that do not follow",
      RowColumns::kTools,
      false,
      {{"jumps by 1 m", passive, thrown},
       {"spins at 1000 rad/s", passive, [](const CaseContext& context) { return spun(context, 50); }}}};
}

Row million_tool_ticks_row() {
  if (!tool::available())
    return {"million-tool-ticks", "requires tools, which were not compiled in", RowColumns::kTools, true};
  return {"million-tool-ticks",
          "a million ticks of the tool alone.  Detects drift and memory leaks of the ticks",
          RowColumns::kTools,
          true,
          {{"unloaded", accurate, [](const CaseContext& context) { return million(context, 0.0); }},
           {"under a constant force", accurate,
            [](const CaseContext& context) { return million(context, 1.0); }}}};
}

}  // namespace palpate::stability
