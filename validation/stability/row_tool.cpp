#include <cmath>

#include "frequency.h"
#include "modal_steps.h"
#include "multirate_theory.h"
#include "palpate/tool/tool.h"
#include "tool_scene.h"

// A rigid ball under a virtual coupling k, b, against a soft cube with the edge L that is held below. The
// hand is the only source of energy. With the handle's whole path d the coupling's spring can store 1/2 k
// d^2, and a cube squeezed by d over its whole face 1/2 E L d^2; the lesser of the two is more than the cube
// can receive, E0.
//
// A coupled system in continuous time is passive. In the partitioned scheme, the tool uses a contact that is
// linear over a period and the cube uses a tool that does not respond within it, and each exchange may create
// energy of the order of the work done in it. No theorem bounds it for every stiffness: "bounded" means here
// that the cube never stores more than 100 E0 and the tool never deviates from the handle's path by more than
// 10 d. More is a failure; so is an end without a message. Stable: not more than E0 and within 2 d (a spring
// released from d swings to -d).
//
// The tool must have touched in every case, including the fast pull: the cube has stored more than rounding.
// (A ball completely inside touches no vertex; it does when it emerges. So exchanges are a fiftieth of the
// pull, 10 ms at most, and the ticks a fifth of that, 1 ms at most: from one to the next the ball moves less
// than its radius.)
//
// An end with an error has a reason. The cube alone has y = w H = 12 and more at the period of 10 ms:
// explicit methods at fixed steps overflow by their formula (modal_steps.h), and must not end before the cube
// stores 1e3 of the energy put in.
//   -> error
// Error control has no reason, except for the light tool below; implicit fixed steps have none.
//   -> error control: stable;  fixed steps: stable, bounded
//
// Statics follows the load from equilibrium to equilibrium; it may find none where the tool has lost contact,
// and must then report this.
//   -> stable, bounded, error
//
// Monolithic: cube and tool are integrated together, passive except for the hand's work.
// - Error control satisfies this and finds its steps for any masses, if it is implicit.
//     -> stable
// - Explicit methods need steps of a few b^-1 m of the light tool, 1e-9 s and 1e6 per period and more, beyond
//   the limit, which they must have reached.
//     -> error (the light tool; also for multi-rate methods, whose fast side, the tool's, is explicit)
// - Fixed steps of a refresh, 10 ms, find the contact open or closed as in the contact rows: no theorem.
//     -> stable, bounded
//
// Density ratio: the coupling of the heavy tool has k = m (60 rad/s)^2 and is critically damped; the light
// tool, 4e-9 kg, is coupled by 300 N/m: a frequency of 3e5 rad/s with ticks of 1 ms.

namespace palpate::stability {

namespace {

constexpr double kRtol = 1e-4;
/// A multi-rate method that ends with an error must have taken this number of fast steps.
constexpr long kFewFastSteps = 1000;

double period_of(const scene::Description& d) { return d.exchange.exchange_period_s; }

/// Returns the spectral radius of an explicit method's step in the cube's fastest mode.
double growth_of_cube(const Column& column, scene::Description d) {
  const double period = period_of(d);
  d.tool.reset();
  d.device.reset();
  d.contacts.clear();
  d.exchange = {};
  d.integrator.name = "linearly-implicit-euler";
  const auto world = loop::assemble(d);
  const double w = largest_frequency(world->system, world->state.view());
  return ModalSteps(column, w * period, 0.5 * d.bodies[0].stiffness_damping_s * w).spectral_radius();
}

Verdicts expect(const CaseContext& context, const scene::Description& d) {
  if (is_static(context.column)) return {Verdict::kStable, Verdict::kBounded, Verdict::kError};
  const double rate = d.tool->coupling.damping_n_s_m / d.tool->mass_kg;
  const bool out_of_steps =
      d.exchange.scheme == scene::ExchangeScheme::kMonolithic && rate * period_of(d) / 10.0 > kMaxSteps;
  if (out_of_steps && (is_explicit(context.column) || is_multirate(context.column))) return {Verdict::kError};
  if (!context.column.fixed) return {Verdict::kStable};
  if (is_explicit(context.column) && growth_of_cube(context.column, d) > 1.0) return {Verdict::kError};
  return {Verdict::kStable, Verdict::kBounded};
}

/// Returns the factor by which positions may overshoot in the first step. The Newmark family starts from the
/// acceleration of the initial state: at most b y and c y^2 of the mode's amplitude, y = w H of the tool on
/// its coupling, with b = 1/4 and c = min(r/4, 1/6), r = 2 z/y = b/(k H), for every spectral radius. A light
/// tool has y = 3e3.
double overshoot(const Column& column, const scene::Description& d) {
  if (d.exchange.scheme != scene::ExchangeScheme::kMonolithic || column.entry->traits.family != "Newmark")
    return 1.0;
  const double y = kToolPeriod * std::sqrt(d.tool->coupling.stiffness_n_m / d.tool->mass_kg),
               r = d.tool->coupling.damping_n_s_m / (d.tool->coupling.stiffness_n_m * kToolPeriod);
  return 1.0 + 0.25 * y + std::min(0.25 * r, 1.0 / 6.0) * y * y;
}

/// Returns the elastic and kinetic energy of the cube [J].
double energy_of_cube(loop::World& world) {
  const loop::Body& cube = world.bodies[0];
  const dynamics::Block* block = world.state.layout().find(cube.block_id);
  const Eigen::Map<const Points> v(world.state.u().data() + block->u_offset, 3, block->u_size / 3);
  return cube.term->energy(world.state.view()) + 0.5 * v.colwise().squaredNorm().dot(cube.masses);
}

StabilityCell run(const CaseContext& context, const scene::Description& d) {
  double path = 0.0, strayed = 0.0;
  const auto& frames = d.device->keyframes;
  for (std::size_t i = 1; i < frames.size(); ++i)
    path += (frames[i].position_m - frames[i - 1].position_m).norm();
  const double external_work_j =
      0.5 * path * path *
      std::min(d.tool->coupling.stiffness_n_m, d.bodies[0].youngs_modulus_pa * kToolCubeEdge);
  double held = 0.0;  // Largest energy of the cube [J].
  const SceneCourse course = run_scene(context, d, kRtol, external_work_j, [&](loop::World& world, double) {
    held = std::max(held, energy_of_cube(world));
    for (const KeyframeSpec& frame : frames)
      strayed = std::max(strayed, (world.tool_pose().translation - frame.position_m).norm() / path - 1.0);
  });
  const double over = overshoot(context.column, d), most = 101.0 * over * over * external_work_j,
               farthest = 10.0 * over - 1.0;
  StabilityCell cell;
  cell.steps = course.steps;
  cell.gain = held / external_work_j - 1.0;
  cell.figure =
      fmt::format("largest energy of the cube {:.1e} J (supplied {:.1e} J), tool deviated {:+.1e} paths",
                  held, external_work_j, strayed);
  if (ended_early(context.column, course.result, course.finite && std::isfinite(strayed + held),
                  course.interrupted, held > most || strayed > farthest, cell)) {
    if (cell.verdict != Verdict::kError) return cell;
    if (is_multirate(context.column)) {
      if (course.run.counters.fast_steps < kFewFastSteps)
        mark_wrong(fmt::format("stopped after {} fast steps", course.run.counters.fast_steps), cell);
    } else if (!context.column.fixed || !is_explicit(context.column)) {
      mark_wrong(gave_up_early(context, course), cell);
    } else if (held <= 1e3 * external_work_j && strayed <= farthest) {
      mark_wrong(fmt::format("stopped at {:.1e} J", held), cell);
    }
    return cell;
  }
  if (held < 1e-9 * external_work_j) {
    cell.verdict = Verdict::kSilent;
    cell.reason = "the tool never touched the cube: nothing was tested";
    return cell;
  }
  cell.verdict = held <= external_work_j && strayed <= 1.0 ? Verdict::kStable
                 : held <= most && strayed <= farthest     ? Verdict::kBounded
                                                           : Verdict::kGrew;
  return cell;
}

double ball_mass(double density) { return density * 4.0 / 3.0 * M_PI * std::pow(kToolRadius, 3); }

}  // namespace

Row density_ratio_row() {
  if (!tool::available()) return {"density-ratio", "requires tools, which were not compiled in"};
  // Rate [rad/s].
  const double above = kToolCubeEdge + kToolRadius, heavy = ball_mass(1e9), light = ball_mass(1e-3),
               rate = 60.0;
  const std::vector<std::pair<double, double>> press = {
      {0.0, above}, {0.1, above - 0.005}, {0.2, above - 0.005}, {0.3, above + 0.005}};
  constexpr double kLightDamping = 4.0;
  const scene::Description with_heavy = under_a_tool(press, heavy, heavy * rate * rate, 2.0 * heavy * rate),
                           with_light = under_a_tool(press, light, 300.0, kLightDamping);
  const auto as_one = [](scene::Description d) {
    d.exchange.scheme = scene::ExchangeScheme::kMonolithic;
    // At vertices: by points, explicit methods would end by too many steps of the light ball only after a
    // cell's 20 s.
    d.contacts[0].method = "analytic";
    return d;
  };
  Row row{"density-ratio",
          "a ball a million times as dense as the soft cube that it presses, or a millionth.  Detects energy "
          "produced by an exchange, tools that fly off, and missed contact"};
  const auto add = [&row](std::string name, const scene::Description& d) {
    row.cases.push_back({std::move(name), [d](const CaseContext& context) { return expect(context, d); },
                         [d](const CaseContext& context) { return run(context, d); }});
  };
  add("tool 1e6 times as dense, partitioned", with_heavy);
  add("tool 1e-6 times as dense, partitioned", with_light);
  add("tool 1e6 times as dense, monolithic", as_one(with_heavy));
  add("tool 1e-6 times as dense, monolithic", as_one(with_light));
  return row;
}

Row swallowed_tool_row() {
  if (!tool::available()) return {"swallowed-tool", "requires tools, which were not compiled in"};
  const auto out_in = [](double duration) {
    return under_a_tool({{0.0, 0.6 * kToolCubeEdge}, {duration, 2.0 * kToolCubeEdge}}, 0.05, 300.0, 4.0,
                        std::min(kToolPeriod, duration / 50.0));
  };
  Row row{"swallowed-tool",
          "a ball that starts entirely inside the soft cube is pulled out.  Detects unbounded forces at deep "
          "penetration"};
  for (const double duration : {1.0, 0.1, 0.01}) {
    const scene::Description d = out_in(duration);
    row.cases.push_back({fmt::format("pulled out in {:g} s", duration),
                         [d](const CaseContext& context) { return expect(context, d); },
                         [d](const CaseContext& context) { return run(context, d); }});
  }
  return row;
}

}  // namespace palpate::stability
