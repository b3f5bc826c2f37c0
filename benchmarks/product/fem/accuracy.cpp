#include <algorithm>
#include <cmath>
#include <limits>

#include "core/clock.h"
#include "palpate/core/error.h"
#include "palpate/integrate/integrators.h"
#include "product/fem.h"
#include "product/fem/beam.h"

namespace palpate::bench {
namespace {

/// End time: the softest beam falls from rest until then; its end has rotated by half a radian, and no
/// element is inverted.
constexpr double kFallFor = 0.2, kYoungsModulus = 1e5;
constexpr double kFirstStep = 1e-3, kShake = 1e-2;
constexpr int kRepeats = 3;

struct Fall {
  VecX end;
  double setup_s, seconds;
};

/// Times the fall from rest. A first step from another state is excluded: it performs one-time work
/// (patterns, maps, orderings), which the compared programs also do beforehand. It moves the nodes relative
/// to each other, so that a solver cannot reuse its solution.
Fall fall(const BeamSize& size, const IntegratorSpec& spec) {
  Beam beam(size.along, size.across, kYoungsModulus);
  const VecX rest = beam.state.q();
  for (Eigen::Index i = 0; i < rest.size(); ++i)
    beam.state.u()[i] = kShake * std::sin(1.7 * static_cast<double>(i));
  const auto stepper = integrate::make_stepper(beam.system, beam.state, spec);
  const auto advance = [&](double t) {
    const double start = wall_seconds();
    if (const dynamics::StepResult r = stepper->advance_to(t); !r.ok())
      fail("bench fem: {}: {}", spec.name, r.message);
    return wall_seconds() - start;
  };
  Fall out;
  out.setup_s = advance(std::min(spec.step_s, kFirstStep));
  beam.state.q() = rest;
  beam.state.u().setZero();
  beam.state.set_time(0.0);
  stepper->reinit(dynamics::ReinitReason::kStateChanged);
  out.seconds = advance(kFallFor);
  out.end = beam.state.q();
  return out;
}

/// Returns |v|_M.
double mass_norm(const VecX& v, const VecX& masses) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < v.size(); ++i) sum += masses[i / 3] * v[i] * v[i];
  return std::sqrt(sum);
}

}  // namespace

std::vector<AccuracyPoint> run_accuracy(const std::string& size_name, bool (*stop)()) {
  const BeamSize& size = size_named(size_name);
  Beam beam(size.along, size.across, kYoungsModulus);
  const VecX exact =
      fall(size, {.name = "cvode-bdf", .rtol = 1e-8, .linear_solver = "auto", .linear_rtol = 1e-6}).end;
  const double way = mass_norm(exact - beam.rest, beam.masses);
  std::vector<AccuracyPoint> points;
  const auto measure = [&](const IntegratorSpec& spec) {
    if (stop && stop()) return;
    AccuracyPoint p{.program = "palpate, " + spec.name, .step_s = spec.step_s, .tolerance = spec.linear_rtol};
    if (spec.name == "cvode-bdf") {
      p.step_s = 0.0;
      p.tolerance = spec.rtol;
    }
    double best = std::numeric_limits<double>::infinity();
    try {
      for (int r = 0; r < kRepeats; ++r) {
        const Fall one = fall(size, spec);
        p.error = mass_norm(one.end - exact, beam.masses) / way;
        p.setup_ms = r == 0 ? 1e3 * one.setup_s : std::min(p.setup_ms, 1e3 * one.setup_s);
        best = std::min(best, one.seconds);
      }
    } catch (const Error&) {
      return;  // The step is too long for its method: no point.
    }
    if (!(p.error < 1.0)) return;
    p.ms_of_ten_ms = 1e3 * best * 1e-2 / kFallFor;
    points.push_back(p);
  };
  for (const double h : {1e-2, 5e-3, 2e-3, 1e-3})
    for (const double rtol : {1e-1, 1e-2, 1e-3, 1e-6})
      measure({.name = "linearly-implicit-euler", .step_s = h, .linear_solver = "auto", .linear_rtol = rtol});
  // Order two allows longer steps for the same error; Newton's tolerance matches the step's error.
  for (const char* name : {"implicit-midpoint", "generalized-alpha", "newmark", "bdf2"})
    for (const double h : {1e-1, 5e-2, 2e-2, 1e-2, 5e-3})
      measure({.name = name,
               .rtol = 1e-2,
               .step_s = h,
               .newton_rtol = 1e-1,
               .linear_solver = "auto",
               .linear_rtol = 1e-1});
  for (const double h : {1e-3, 5e-4, 2e-4}) measure({.name = "symplectic-euler", .step_s = h});
  for (const double rtol : {1e-1, 1e-2, 1e-3, 1e-4})
    measure({.name = "cvode-bdf", .rtol = rtol, .linear_solver = "auto", .linear_rtol = 1e-3});
  return points;
}

}  // namespace palpate::bench
