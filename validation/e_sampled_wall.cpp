#include <numbers>
#include <random>

#include "cases.h"
#include "palpate/device/passivity.h"

// Problem: passivity of a virtual wall F = -K x - B (x_k - x_{k-1})/T in x > 0, with its force held over T,
// on a device with the viscous damping b.
//
// Exact answer (Colgate and Schenkel 1997): passive where b > K T/2 + |B|; with one tick of delay and B = 0,
// b > 3 K T/2.
//
// Measured: the energy at the port (device/passivity.h) may not fall below zero within the bound for any
// motion of the hand. Outside the bound, random motions do not find the counter-examples:
// - the triangle wave with period 2T and amplitude A, completely in the wall, changes the energy by (8
//   A^2/T)(b - K T/2 - B) per cycle for B >= 0;
// - with one tick of delay, a sine with frequency w changes it by sum D^2 (b/T - (K/2)
//   sin(3wT/2)/sin(wT/2)) per cycle, which is negative for b = 0.99 * 3 K T/2 where w T is small.

namespace palpate::validation {
namespace {

constexpr double kT = 1e-3;

/// Passivity observer, or one with a defect.
class FaultyObserver {
 public:
  FaultyObserver(double damping, const std::string& fault)
      : fault_(fault), observer_(fault == "friction-left-out" ? 0.0 : damping) {}
  void sample(double t, const Pose& handle, const Wrench& next) {
    if (fault_ == "held-too-early") observer_.hold(next);
    observer_.sample(t, handle);
    observer_.hold(next);
  }
  double energy() const { return observer_.energy(); }
  double least_energy() const { return observer_.least_energy(); }

 private:
  std::string fault_;
  device::PassivityObserver observer_;
};

/// Virtual wall, driven along x(0), x(1), ...; `after` receives the observer after each sample.
struct Wall {
  double K, B, b;
  bool delayed = false;
  bool one_sided = true;
  std::string fault{};

  template <class Motion, class After>
  void drive(int count, const Motion& x_at, const After& after) const {
    FaultyObserver observer(b, fault);
    double last = x_at(0), force = 0.0;
    for (int k = 0; k < count; ++k) {
      const double x = x_at(k);
      const double now = x > 0.0 || !one_sided ? -K * x - B * (x - last) / kT : 0.0;
      observer.sample(k * kT, {Quat::Identity(), Vec3(x, 0, 0)},
                      {Vec3::Zero(), Vec3(delayed ? force : now, 0, 0)});
      force = now;
      last = x;
      after(k, observer);
    }
  }
};

/// Returns the least energy over random motions, each starting outside the wall or at its surface.
double least_energy(const Wall& wall, int motions) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  double least = 0.0;
  for (int i = 0; i < motions; ++i) {
    std::vector<double> x(2000, 0.0);
    double v = 0.0;
    const double kept = i % 2 ? 0.99 : 0.0;  // Smooth and rough motions.
    for (std::size_t k = 1; k < x.size(); ++k) {
      v = kept * v + (kept > 0.0 ? 1e-5 : 1e-4) * normal(random);
      x[k] = 0.999 * x[k - 1] + v;
    }
    wall.drive(
        2000, [&](int k) { return x[static_cast<std::size_t>(k)]; },
        [&](int, const FaultyObserver& o) { least = std::min(least, o.least_energy()); });
  }
  return least;
}

double triangle_cycle(const Wall& wall, double A) {
  double before = 0.0, cycle = 0.0;
  wall.drive(
      9, [A](int k) { return 2.0 * A + (k % 2 ? A : -A); },
      [&](int k, const FaultyObserver& o) {
        if (k == 6) before = o.energy();
        if (k == 8) cycle = o.energy() - before;
      });
  return cycle;
}

double sine_cycle(const Wall& wall, int period) {
  double before = 0.0, cycle = 0.0;
  const double w = 2.0 * std::numbers::pi / period;
  wall.drive(
      2 * period + 1, [w](int k) { return 1e-3 * std::sin(w * k); },
      [&](int k, const FaultyObserver& o) {
        if (k == period) before = o.energy();
        if (k == 2 * period) cycle = o.energy() - before;
      });
  return cycle;
}

std::vector<Measurement> run(const std::string& fault) {
  std::vector<Measurement> out;
  const double K = 1500.0, A = 1e-3;
  for (const double B : {0.0, 0.4, -0.4}) {
    const double b = 0.5 * K * kT + std::abs(B);
    const double least = least_energy({.K = K, .B = B, .b = b, .fault = fault}, 60);
    out.push_back(
        {.quantity = fmt::format("minimum energy at the port at the theoretical limit, B = {} N s/m [J]", B),
         .computed = least,
         .error = std::max(0.0, -least),
         .bar = 1e-9});
  }
  for (const double b : {0.9, 1.3}) {
    const double B = 0.4, exact = 8.0 * A * A / kT * (b - 0.5 * K * kT - B),
                 found = triangle_cycle({.K = K, .B = B, .b = b, .fault = fault}, A);
    out.push_back({.quantity = fmt::format("energy of a cycle of the triangle wave, b = {} N s/m [J]", b),
                   .computed = found,
                   .exact = exact,
                   .error = std::abs(found / exact - 1.0),
                   .bar = 1e-10});
  }
  const double below = sine_cycle({K, 0.0, 0.99 * 1.5 * K * kT, true, false, fault}, 400),
               above = sine_cycle({K, 0.0, 1.01 * 1.5 * K * kT, true, false, fault}, 400);
  out.push_back(
      {.quantity = "one tick of delay: cycles with energy of the wrong sign, b = 3KT/2 -+ 1 % [count]",
       .computed = static_cast<double>((below >= 0.0) + (above <= 0.0)),
       .error = static_cast<double>((below >= 0.0) + (above <= 0.0)),
       .bar = 0.0});
  return out;
}

}  // namespace

ValidationCase sampled_wall() {
  return {.name = "sampled-wall",
          .section = "E",
          .summary = "passivity of a sampled virtual wall: b > K T/2 + |B|, and 3 K T/2 with a tick of delay",
          .why = "a wall that returns more energy than the hand supplies vibrates with any hand",
          .quick = true,
          .run = run,
          .faults = {{"friction-left-out", "energy"}, {"held-too-early", "triangle wave"}}};
}

}  // namespace palpate::validation
