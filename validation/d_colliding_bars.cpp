#include <cmath>

#include "cases.h"
#include "images.h"
#include "palpate/contact/contact_force.h"
#include "palpate/core/error.h"
#include "palpate/dynamics/system.h"
#include "palpate/fem/soft_body.h"
#include "palpate/integrate/integrators.h"
#include "palpate/mesh/boundary.h"
#include "palpate/mesh/generators.h"

// Problem: two equal bars with length L, nu = 0, collide end to end, each at v/2.
//
// Exact answer (d'Alembert; St Venant 1867): from the touching ends a compression front runs into each bar
// with the speed c = sqrt(E/rho); behind it the bars are at rest under the stress rho c v/2. It returns from
// the free end as a release front, behind which the bar has the velocity of the other: at 2 L/c it reaches
// the contact, and the bars separate, each with the velocity that the other had.
//
// Measured: duration of contact and mean velocities after it, limit 2e-2, with a lower limit on the order.
// - Contact spring: k = E/(2 h) per area is as stiff as two elements of length h in series. It counts as a
//   length 2 h of bar, and vanishes with h as the elements' errors do.
// - Slow waves: waves that elements of length h carry too slowly vanish less fast. They stay behind the
//   front, are still in the bar when it separates, and their energy is missing from the mean velocity.
// - Duration: two errors delay the end of the contact, the spring, of order 1 in h, and the width of the
//   front, which grows as h^(2/3) (elements carry a wave with wave number q at c (1 - (q h)^2/24): the front
//   is an Airy function with the width (h^2 c t/8)^(1/3)). Up to 100 elements the first dominates, beyond
//   them the second, so that the order falls from 1 towards 2/3.
// - Rim: points on the rim of an end are as near to the other bar's side as to its end, and triangles at
//   the rim carry less: the contact spring is softer by 2 e/w, e the spacing of the points and w the width, a
//   tenth.
//
// The steps are a sixteenth of h/c, so that the time integration error is small compared with the error in h.

namespace palpate::validation {
namespace {

constexpr double kLength = 0.1, kWidth = 0.01, kYoung = 1e6, kDensity = 1000.0, kSpeed = 0.1;
const double kWave = std::sqrt(kYoung / kDensity);

struct Bar {
  TetMesh rest;
  int block_id;
  contact::NodeSurface surface;
  VecX masses;
};

Bar add_bar(dynamics::State& state, dynamics::System& system, int elements, double centre, double velocity) {
  Bar bar{mesh::box(Vec3(kLength, kWidth, kWidth), {elements, 1, 1}), -1, {}, {}};
  bar.rest.nodes.row(0).array() += centre;
  dynamics::BlockSpec nodes;
  nodes.name = centre < 0.0 ? "left" : "right";
  nodes.q_size = nodes.u_size = static_cast<int>(bar.rest.nodes.size());
  nodes.q_scale = kSpeed * kLength / kWave;
  nodes.u_scale = kSpeed;
  VecX u = VecX::Zero(nodes.u_size);
  for (Eigen::Index i = 0; i < u.size(); i += 3) u[i] = velocity;
  bar.block_id = state.insert(nodes, bar.rest.nodes.reshaped(), u);
  fem::Material material;
  material.youngs_modulus = kYoung;
  material.poissons_ratio = 0.0;
  material.density = kDensity;
  bar.masses = fem::lumped_masses(bar.rest, material.density);
  system.add(
      std::make_shared<fem::SoftBody>(nodes.name, bar.rest, material, fem::SoftBodyOptions{}, bar.block_id));
  system.add(fem::make_lumped_mass(bar.rest, material, bar.block_id));
  const mesh::Boundary boundary = mesh::boundary(bar.rest);
  bar.surface = {bar.block_id, boundary.node_of_vertex, boundary.surface.faces};
  return bar;
}

struct Collision {
  double lasts = std::nan("");     ///< From first to last force [s].
  double left = 0.0, right = 0.0;  ///< Mean velocities after the contact [m/s].
};

double mean_velocity(const Bar& bar, const dynamics::StateView& state) {
  const dynamics::Block& block = *state.layout->find(bar.block_id);
  double sum = 0.0;
  for (Eigen::Index i = 0; i < bar.masses.size(); ++i) sum += bar.masses[i] * state.u[block.u_offset + 3 * i];
  return sum / bar.masses.sum();
}

Collision collide(int elements, const std::string& fault) {
  dynamics::State state;
  dynamics::System system;
  const double h = kLength / elements;
  const Bar left = add_bar(state, system, elements, -0.5 * kLength, 0.5 * kSpeed),
            right = add_bar(state, system, elements, 0.5 * kLength, -0.5 * kSpeed);
  const auto at_rest = [](const Bar& bar) { return mesh::boundary(bar.rest).surface.vertices; };
  auto source = contact::make_distance_source(left.surface, at_rest(left), right.surface, at_rest(right),
                                              {.candidate_gap = 0.02 * kLength, .spacing = 0.05 * kWidth});
  if (fault == "force-on-one-side")
    source = spoiled(std::move(source), [](auto& samples) {
      for (auto& s : samples)
        for (double& w : s.b.weight) w *= 1.0 - 1e-1;
    });
  if (fault == "few-samples")
    source = spoiled(std::move(source), [](auto& samples) { samples.resize(samples.size() / 100); });
  const auto contact = std::make_shared<contact::ContactForce>();
  ContactSpec law;
  law.stiffness_pa_m = kYoung / (2.0 * h);
  contact->add_pair(std::move(source), law);
  system.add(std::static_pointer_cast<dynamics::ForceTerm>(contact));
  contact->refresh(state.view());
  system.prepare(state.view());
  IntegratorSpec spec;
  spec.name = "symplectic-euler";
  const double step = h / kWave / 16.0, end = 2.5 * kLength / kWave;
  spec.step_s = step;
  const auto stepper = integrate::make_stepper(system, state, spec);
  double first = std::nan(""), last = std::nan("");
  const int steps = static_cast<int>(std::ceil(end / step)), per_query = steps / 10;
  for (int i = 1; i <= steps; ++i) {
    if (!stepper->advance_to(i * step).ok()) return {};
    if (i % per_query == 0 && contact->refresh(state.view()))
      stepper->reinit(dynamics::ReinitReason::kContactRefreshed);
    if (contact->energy(state.view()) == 0.0) continue;
    if (std::isnan(first)) first = (i - 1) * step;
    last = i * step;
  }
  return {last - first, mean_velocity(left, state.view()), mean_velocity(right, state.view())};
}

/// Returns the last three levels: with fewer than 50 elements the slow waves have not separated from the
/// front.
std::vector<double> last_three(const std::vector<double>& all) { return {all.end() - 3, all.end()}; }

std::vector<Measurement> run(const std::string& fault) {
  std::vector<Measurement> out;
  const double exact = 2.0 * kLength / kWave;
  {
    std::vector<double> h, time, velocity;
    Collision one;
    for (const int elements : {13, 25, 50, 100, 200}) {
      one = collide(elements, fault);
      h.push_back(kLength / elements);
      time.push_back(std::abs(one.lasts / exact - 1.0));
      velocity.push_back(
          std::max(std::abs(one.left / (-0.5 * kSpeed) - 1.0), std::abs(one.right / (0.5 * kSpeed) - 1.0)));
    }
    out.push_back({.quantity = "contact duration, 200 elements [s]",
                   .computed = one.lasts,
                   .exact = exact,
                   .error = std::max(time[3], time[4]),
                   .bar = 2e-2,
                   .order = validation::fitted_order(h, time),
                   .order_low = 0.8,
                   .note = "error: the larger of 100 and 200 elements; order over 13 to 200",
                   .refinement = {"element size [m]", h, time}});
    out.push_back({.quantity = "mean velocity of the left bar after contact, 200 elements [m/s]",
                   .computed = one.left,
                   .exact = -0.5 * kSpeed,
                   .error = std::max(velocity[3], velocity[4]),
                   .bar = 2e-2,
                   .order = validation::fitted_order(last_three(h), last_three(velocity)),
                   .order_low = 0.4,
                   .note = "error: the larger of both bars, of 100 and 200 elements; order over 50 to 200",
                   .refinement = {"element size [m]", h, velocity}});
  }
  return out;
}

}  // namespace

ValidationCase colliding_bars() {
  return {.name = "colliding-bars",
          .section = "D",
          .summary = "two equal elastic bars collide: contact duration, velocities after contact",
          .why =
              "contact, waves and release combined: only the correct stiffness, mass and opening of the "
              "contact give 2 L/c and the exchange of velocities (d'Alembert; St Venant 1867)",
          .quick = true,
          .run = run,
          .faults = {{"force-on-one-side", "mean velocity"}, {"few-samples", "mean velocity"}}};
}

}  // namespace palpate::validation
