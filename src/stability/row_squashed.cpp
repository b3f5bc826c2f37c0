#include <cmath>
#include <random>

#include "frequency.h"
#include "palpate/core/error.h"
#include "palpate/fem/soft_body.h"
#include "palpate/mesh/generators.h"
#include "palpate/mesh/quality.h"
#include "scene_run.h"

// A free damped body whose nodes are put where no body's nodes should be, and let go without speed.  The
// energy is then elastic, E0, and
//     d(kinetic + elastic)/dt = -(damping power) <= 0:
// it never rises, and the body comes to rest where the elastic force vanishes.  That is the rest shape in
// some position, or a true local minimum with an inverted element (it exists: an element inverted through a
// vertex is held by the sign convention of its rotation); at least 90 % of random starts must find the rest
// shape.  For each start:
// - at rest: elastic and kinetic energy below 1e-6 E0, no inverted element;
// - energy rise: the largest over any earlier value;
// - an element that is inverted (its volume is negative, found here from the nodes alone) must be reported by
//   the body.
//
// Accurate: >= 90 % at rest and no rise beyond the tolerance.  Stable: no rise beyond it.  Bounded: a rise of
// at most E0, for a fixed step the bound below.
//
// Error control follows the exact flow within its tolerance, through the corners of the rotation field as
// well (R jumps where two signed singular values cancel, the energy does not): rise <= (steps) x rtol, taken
// as 100 rtol.
//   -> accurate
// A flow has no say in which of the two ends a start finds, so the count over random starts belongs to the
// problem, not to the method.
//
// Fixed steps of H = 5 ms (y = w H up to 2): no theorem for a potential that is not convex, so any end with a
// message is accepted.  The effect of one linearised step from a state of energy E0 = T0 + V0 is known:
//     (M + ...) u1 = M u0 + H f
// with a positive semi-definite remainder, and f.M^-1 f <= 2 w^2 V0 for an energy that is quadratic at a
// given rotation, so
//     sqrt T1 <= sqrt T0 + y sqrt V0,    sqrt V1 <= sqrt V0 + y sqrt T1
// (V1 with the old rotation; the new one takes the least of the shear part).  The matrix [1 y; y 1+y^2] of
// this majorant has the norm g = 1 + y^2/2 + y sqrt(1 + y^2/4): rise <= (g^2 - 1) E0.
//
// Statics looks for a stationary point, and a saddle is one: any end with a message is accepted.

namespace palpate::stability {
namespace {

constexpr double kH = 5e-3, kDuration = 2.0, kRtol = 1e-4, kAtRest = 1e-6, kSettled = 1e-10;
constexpr double kSize = 0.1, kPerturbation = 1e-9;
constexpr double kShareAtRest = 0.9;

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
  const double g = 1.0 + 0.5 * y * y + y * std::sqrt(1.0 + 0.25 * y * y);
  return g * g - 1.0;
}

/// Outcome of all the starts of a cell.
struct Tally {
  int starts = 0, at_rest = 0, elsewhere = 0, moving = 0, failed = 0;
  double rise = 0.0, bound = 1.0;  ///< of the energy, relative to E0
  bool unreported = false, finite = true, interrupted = false;
  dynamics::StepResult failure;
  long steps = 0;
};

void let_go(const Lab& lab, Body& body, Tally& tally) {
  ++tally.starts;
  if (body.inverted() && body.system.inspect(body.state.view()).first.element < 0) tally.unreported = true;
  const auto stepper = make_stepper(lab.column, body.system, body.state, spec_of(lab.column, kRtol, kH));
  stepper->set_interrupt(lab.expired);
  const double start = body.energy();
  double lowest = start;
  for (int i = 1; i * kH <= kDuration && lowest > kSettled * start; ++i) {
    if (lab.time_is_up()) {
      tally.interrupted = true;
      break;
    }
    const dynamics::StepResult result = stepper->advance_to(i * kH);
    if (!result.ok()) {
      if (result.status == dynamics::StepStatus::kInterrupted) tally.interrupted = true;
      ++tally.failed;
      tally.failure = result;
      break;
    }
    const double energy = body.energy();
    tally.finite = tally.finite && std::isfinite(energy);
    tally.rise = std::max(tally.rise, (energy - lowest) / start);
    lowest = std::min(lowest, energy);
    if (!tally.finite) break;
  }
  tally.steps += stepper->counters().steps;
  if (tally.interrupted || tally.failed) return;
  const bool still = body.system.kinetic_energy(body.state.view()) <= kAtRest * start;
  const bool low = body.system.potential_energy(body.state.view()) <= kAtRest * start && !body.inverted();
  ++(still && low ? tally.at_rest : still ? tally.elsewhere : tally.moving);
}

StabilityCell verdict_on(const Lab& lab, const Tally& tally) {
  StabilityCell cell;
  cell.steps = tally.steps;
  cell.gain = tally.rise;
  cell.figure =
      fmt::format("{} of {} at rest, {} at rest elsewhere, {} moving, {} failed; energy rise {:.1e}",
                  tally.at_rest, tally.starts, tally.elsewhere, tally.moving, tally.failed, tally.rise);
  if (ended_early(lab.column, tally.failure, tally.finite, tally.interrupted, tally.rise > tally.bound, cell))
    return cell;
  if (tally.unreported) {
    cell.verdict = Verdict::kSilent;
    cell.reason = "an inverted element was not reported";
    return cell;
  }
  const bool no_rise = tally.rise <= 100.0 * kRtol;
  cell.verdict = no_rise && tally.at_rest >= kShareAtRest * tally.starts ? Verdict::kAccurate
                 : no_rise                                               ? Verdict::kStable
                 : tally.rise <= tally.bound                             ? Verdict::kBounded
                                                                         : Verdict::kGrew;
  return cell;
}

Verdicts expect(const Lab& lab) {
  if (!lab.column.fixed && !is_static(lab.column)) return {Verdict::kAccurate};
  return {Verdict::kAccurate, Verdict::kStable, Verdict::kBounded, Verdict::kError};
}

SubCase start_of(std::string name, Placement place) {
  return {std::move(name), expect, [place](const Lab& lab) {
            Tally tally;
            if (lab.column.fixed) tally.bound = std::max(1.0, bound_of_a_step());
            for (int seed = 0; seed < lab.seeds && !tally.failed && !tally.interrupted; ++seed) {
              std::mt19937 random(static_cast<unsigned>(seed) + 1);
              Points placed = mesh::box(Vec3::Constant(kSize), {1, 1, 1}).nodes;
              place(placed, random);
              Body body(placed);
              let_go(lab, body, tally);
            }
            return verdict_on(lab, tally);
          }};
}

}  // namespace

Row squashed_row() {
  const auto along = [](const Vec3& scale) {
    return [scale](Points& x, std::mt19937& random) {
      x = (scale.asDiagonal() * x).eval();
      perturb(x, random);
    };
  };
  return {"squashed",
          "all nodes on a plane, a line, a mirror image, a point (each perturbed by 1e-9 m), or scattered at "
          "random",
          RowColumns::kSteppers,
          false,
          {start_of("on a plane", along(Vec3(1, 1, 0))), start_of("on a line", along(Vec3(1, 0, 0))),
           start_of("mirror image", along(Vec3(1, 1, -1))), start_of("on a point", along(Vec3::Zero())),
           start_of("scattered", [](Points& x, std::mt19937& random) {
             std::uniform_real_distribution<double> uniform(-0.5 * kSize, 0.5 * kSize);
             for (double& value : x.reshaped()) value = uniform(random);
           })}};
}

}  // namespace palpate::stability
