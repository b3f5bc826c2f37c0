#include <cmath>
#include <random>
#include <vector>

#include "frequency.h"
#include "palpate/core/error.h"
#include "palpate/fem/soft_body.h"
#include "palpate/mesh/generators.h"
#include "palpate/mesh/quality.h"
#include "scene_run.h"

// A free damped body whose nodes are put into an inadmissible shape and released without speed. The energy is
// then elastic, E0, and
//     d(kinetic + elastic)/dt = -(damping power) <= 0:
// it never rises, and the body comes to rest where the elastic force vanishes. This is the rest shape in some
// position, or a true local minimum with an inverted element (it exists: an element inverted through a vertex
// is kept there by the sign convention of its rotation); at least 90 % of random starts must reach the rest
// shape. For each start:
// - at rest: elastic and kinetic energy below 1e-6 E0, no inverted element;
// - energy rise: the largest over any earlier value;
// - an inverted element (negative volume, computed here from the nodes alone) must be reported by the body.
//
// Accurate: >= 90 % at rest and no rise beyond the tolerance. Stable: no rise beyond it. Bounded: a rise of
// at most E0, for a fixed step the bound below.
//
// Error control follows the exact flow within its tolerance, also through the corners of the rotation field
// (R jumps where two signed singular values cancel, the energy does not): rise <= (steps) x rtol, taken as
// 100 rtol.
//   -> accurate
// The method does not determine which of the two ends a start reaches, so the count over random starts
// belongs to the problem.
//
// Fixed steps of H = 5 ms (y = w H up to 2): no theorem for a potential that is not convex. For a start 1e-9
// m from where rotations jump, Newton's method may fail at any step: this start is tried once more, with the
// first period in steps of 2^-12, 2^-11 .. of it, in which the body moves off the singular set (by 1e-7 m
// within 4e-5 s at f/m = E/(rho L)). Nine starts of ten must succeed; with explicit methods, and under error
// control, all. The effect of one linearised step from a state with energy E0 = T0 + V0 is known:
//     (M + ...) u1 = M u0 + H f
// with a positive semi-definite remainder, and f.M^-1 f <= 2 w^2 V0 for an energy that is quadratic at a
// given rotation, so
//     sqrt T1 <= sqrt T0 + y sqrt V0,    sqrt V1 <= sqrt V0 + y sqrt T1
// (V1 with the old rotation; the new one minimises the shear part). The exact tangent of a body thrown apart
// need not be semi-definite, but the step ensures that the remainder along u1 is more than -1/10 of its mass,
// so that with c = 10/9
//     sqrt T1 <= c (sqrt T0 + y sqrt V0).
// The symmetric matrix [c cy; cy 1+cy^2] of this majorant has the trace s = 1 + c + c y^2 and the determinant
// c, so the norm g = s/2 + sqrt(s^2/4 - c): rise <= (g^2 - 1) E0.
//   -> accurate, stable, bounded
//
// SDIRK 2(1) of SUNDIALS has its second stage at the step's start, c = (1, 0), where Newton's method meets
// the jumping rotations again: it may fail.
//   -> error as well
//
// Damping. At least half of the energy must be dissipated by the end (2 s; drag alone reduces the energy of
// motion to e^-4, and the slowest mode decays at 14/s). Nodes thrown apart at random are followed for 0.2 s
// only: the elastic part has decayed, but a quarter of the kinetic energy (6 of 24 directions) is rigid
// motion, which drag hardly reduces; a fifth of the total is required. This start has ten times as many seeds
// at fixed steps.
//   -> stable, bounded; error control: stable
// This start found steps along negative curvature: with a step matrix that a Cholesky factor accepts, with an
// eigenvalue near zero, linearly implicit Euler created 42 E0 from the worst of 10 seeds and 102 E0 from the
// worst of 100, nearly all in one step.
//
// Statics seeks a stationary point, and a saddle is one: any end with a message is accepted.

namespace palpate::stability {
namespace {

constexpr double kH = 5e-3, kRtol = 1e-4, kAtRest = 1e-6, kSettled = 1e-10;
constexpr double kSize = 0.1, kPerturbation = 1e-9;
constexpr double kShareAtRest = 0.9;
constexpr int kHalvings = 12;
constexpr double kFastest = 3.0;     // Largest speed of a node in each direction [m/s], about the wave speed.
constexpr double kFallMoving = 0.2;  // Fraction of E0.

using Placement = std::function<void(Points&, std::mt19937&)>;

void perturb(Points& x, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-kPerturbation, kPerturbation);
  for (double& value : x.reshaped()) value += uniform(random);
}

struct Body {
  TetMesh rest = mesh::box(Vec3::Constant(kSize), {1, 1, 1});
  dynamics::State state;
  dynamics::System system;
  std::shared_ptr<fem::SoftBody> term;

  explicit Body(const Points& placed) {
    fem::Material material;
    material.youngs_modulus = 1e4;
    material.stiffness_damping = 4e-3;
    material.mass_damping = 1.0;
    dynamics::BlockSpec spec;
    spec.name = "body";
    spec.q_size = spec.u_size = static_cast<int>(placed.size());
    spec.q_scale = kSize;
    spec.u_scale = std::sqrt(material.youngs_modulus / material.density);
    const int id = state.insert(spec, placed.reshaped(), VecX::Zero(placed.size()));
    term = std::make_shared<fem::SoftBody>("body", rest, material, fem::SoftBodyOptions{}, id);
    system.add(std::static_pointer_cast<dynamics::ForceTerm>(term));
    system.add(fem::make_lumped_mass(rest, material.density, id));
    system.prepare(state.view());
  }
  double energy() { return system.kinetic_energy(state.view()) + system.potential_energy(state.view()); }
  bool inverted() const {
    TetMesh now = rest;
    now.nodes = Eigen::Map<const Points>(state.q().data(), 3, rest.nodes.cols());
    for (int t = 0; t < now.tets.cols(); ++t)
      if (mesh::tet_volume(now, t) < 0.0) return true;
    return false;
  }
};

double bound_of_a_step() {
  Body body(mesh::box(Vec3::Constant(kSize), {1, 1, 1}).nodes);
  const double y = largest_frequency(body.system, body.state.view()) * kH;
  constexpr double c = 10.0 / 9.0;
  const double s = 1.0 + c + c * y * y, g = 0.5 * s + std::sqrt(0.25 * s * s - c);
  return g * g - 1.0;
}

/// Outcome of all starts of a cell.
struct Tally {
  int starts = 0, at_rest = 0, elsewhere = 0, moving = 0, failed = 0, short_steps = 0;
  double rise = 0.0, bound = 1.0;  ///< Rise of the energy, relative to E0.
  bool beyond() const { return !(rise <= bound); }
  double least_fall = 1.0;  ///< Least fall of the energy over all starts.
  bool unreported = false, silent = false, finite = true, interrupted = false;
  dynamics::StepResult failure;
  long steps = 0;
};

/// Duration of a start, and its limits.
struct Bars {
  double duration = 2.0;  ///< [s]
  double fall = 0.5;      ///< Fraction of E0 that must be dissipated by then.
  bool must_rest = true;
};

/// Returns the ends of the periods; with short first steps the first period is divided at 2^-12, 2^-11 .. of
/// itself.
std::vector<double> period_ends(double duration, bool short_steps) {
  std::vector<double> ends;
  if (short_steps)
    for (int k = kHalvings; k > 0; --k) ends.push_back(std::ldexp(kH, -k));
  for (int i = 1; i * kH <= duration * (1.0 + 1e-9); ++i) ends.push_back(i * kH);
  return ends;
}

/// Releases the body. Returns false if a step failed; the tally then has its result, and the rise of the
/// energy until then.
bool let_go(const CaseContext& context, Body& body, const Bars& bars, bool short_steps, Tally& tally) {
  if (body.inverted() && body.system.inspect(body.state.view()).first.element < 0) tally.unreported = true;
  const auto stepper =
      make_stepper(context.column, body.system, body.state, spec_of(context.column, kRtol, kH));
  stepper->set_interrupt(context.expired);
  const double start = body.energy();
  double lowest = start;
  for (const double end : period_ends(bars.duration, short_steps)) {
    if (!(lowest > kSettled * start)) break;
    const dynamics::StepResult result = stepper->advance_to(end);
    tally.interrupted = context.time_is_up() || result.status == dynamics::StepStatus::kInterrupted;
    if (tally.interrupted) return true;
    if (!result.ok()) {
      tally.failure = result;
      tally.silent = tally.silent || result.message.empty();
      return false;
    }
    const double energy = body.energy();
    tally.finite = tally.finite && std::isfinite(energy);
    if (!tally.finite) return true;
    tally.rise = std::max(tally.rise, (energy - lowest) / start);
    lowest = std::min(lowest, energy);
  }
  tally.steps += stepper->counters().steps;
  tally.least_fall = std::min(tally.least_fall, 1.0 - lowest / start);
  const bool still = body.system.kinetic_energy(body.state.view()) <= kAtRest * start;
  const bool low = body.system.potential_energy(body.state.view()) <= kAtRest * start && !body.inverted();
  ++(still && low ? tally.at_rest : still ? tally.elsewhere : tally.moving);
  return true;
}

StabilityCell verdict_on(const CaseContext& context, const Bars& bars, const Tally& tally) {
  StabilityCell cell;
  cell.steps = tally.steps;
  cell.gain = tally.rise;
  cell.figure = fmt::format(
      "{} of {} at rest, {} at rest elsewhere, {} moving, {} failed, {} with short first steps; energy rise "
      "{:.1e}, fall {:.2f}",
      tally.at_rest, tally.starts, tally.elsewhere, tally.moving, tally.failed, tally.short_steps, tally.rise,
      tally.least_fall);
  const bool may_fail = context.column.fixed && !is_explicit(context.column) && !is_static(context.column);
  const bool gave_up = tally.starts - tally.failed < (may_fail ? kShareAtRest : 1.0) * tally.starts;
  if (tally.silent) {
    cell.verdict = Verdict::kSilent;
    cell.reason = "a start failed without a message";
    return cell;
  }
  if (ended_early(context.column, gave_up ? tally.failure : dynamics::StepResult{}, tally.finite,
                  tally.interrupted, tally.beyond(), cell))
    return cell;
  if (tally.unreported) {
    cell.verdict = Verdict::kSilent;
    cell.reason = "an inverted element was not reported";
    return cell;
  }
  if (!tally.beyond() && tally.least_fall < bars.fall) {
    cell.verdict = Verdict::kWrong;
    cell.reason = fmt::format("a start kept more than {:.2f} of its energy despite damping", 1.0 - bars.fall);
    return cell;
  }
  const bool no_rise = tally.rise <= 100.0 * kRtol;
  cell.verdict = no_rise && bars.must_rest && tally.at_rest >= kShareAtRest * tally.starts
                     ? Verdict::kAccurate
                 : no_rise         ? Verdict::kStable
                 : !tally.beyond() ? Verdict::kBounded
                                   : Verdict::kGrew;
  return cell;
}

Verdicts expect(const CaseContext& context) {
  if (!context.column.fixed) return {Verdict::kAccurate};
  if (is_static(context.column)) return {Verdict::kAccurate, Verdict::kStable, Verdict::kError};
  Verdicts out{Verdict::kAccurate, Verdict::kStable, Verdict::kBounded};
  if (context.column.name == "ark-dirk-sdirk212") out.add(Verdict::kError);
  return out;
}

Verdicts expect_moving(const CaseContext& context) {
  if (!context.column.fixed) return {Verdict::kStable};
  if (is_static(context.column)) return expect(context);
  return {Verdict::kStable, Verdict::kBounded};
}

using Velocities = std::function<void(VecX&, std::mt19937&)>;

StabilityCell run(const CaseContext& context, const Bars& bars, int seeds, const Placement& place,
                  const Velocities& throw_it) {
  Tally tally;
  if (context.column.fixed) tally.bound = std::max(1.0, bound_of_a_step());
  for (int seed = 0; seed < seeds && !tally.interrupted && tally.finite; ++seed) {
    std::mt19937 random(static_cast<unsigned>(seed) + 1);
    Points placed = mesh::box(Vec3::Constant(kSize), {1, 1, 1}).nodes;
    place(placed, random);
    VecX speeds = VecX::Zero(placed.size());
    if (throw_it) throw_it(speeds, random);
    bool done = false;
    for (const bool short_steps : {false, true}) {
      Body body(placed);
      body.state.u() = speeds;
      done = let_go(context, body, bars, short_steps, tally);
      if (done && short_steps) ++tally.short_steps;
      if (done || !context.column.fixed || is_static(context.column)) break;
    }
    ++tally.starts;
    if (!done) ++tally.failed;
  }
  return verdict_on(context, bars, tally);
}

SubCase start_of(std::string name, const Placement& place) {
  return {std::move(name), expect,
          [place](const CaseContext& context) { return run(context, {}, context.seeds, place, nullptr); }};
}

void scatter(Points& x, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-0.5 * kSize, 0.5 * kSize);
  for (double& value : x.reshaped()) value = uniform(random);
}

void throw_apart(VecX& u, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-kFastest, kFastest);
  for (double& value : u) value = uniform(random);
}

}  // namespace

Row squashed_row() {
  const auto along = [](const Vec3& scale) {
    return [scale](Points& x, std::mt19937& random) {
      x = (scale.asDiagonal() * x).eval();
      perturb(x, random);
    };
  };
  Row row{
      "squashed",
      "all nodes on a plane, a line, a mirror image, a point (each perturbed by 1e-9 m), or scattered at "
      "random, at rest or at random speeds.  Detects energy gained where rotations jump, missing damping, "
      "and inverted elements that are not reported"};
  row.cases = {start_of("on a plane", along(Vec3(1, 1, 0))), start_of("on a line", along(Vec3(1, 0, 0))),
               start_of("mirror image", along(Vec3(1, 1, -1))), start_of("on a point", along(Vec3::Zero())),
               start_of("scattered", scatter)};
  row.cases.push_back({"scattered and moving", expect_moving, [](const CaseContext& context) {
                         const Bars bars{.duration = 0.2, .fall = kFallMoving, .must_rest = false};
                         return run(context, bars, (context.column.fixed ? 10 : 1) * context.seeds, scatter,
                                    throw_apart);
                       }});
  row.core = 4;
  return row;
}

}  // namespace palpate::stability
