#include <Eigen/QR>
#include <cmath>
#include <random>

#include "cases.h"
#include "faults.h"
#include "palpate/dynamics/system.h"
#include "palpate/fem/soft_body.h"
#include "palpate/integrate/integrators.h"
#include "palpate/mesh/generators.h"

// Problem: a free soft body that spins with w in relative equilibrium, with stiffness damping: v = w x x and,
// at every node, f(x) = m w x (w x x). The solution of
//     r(x) = f(x) - M W x = 0,   W x = w x (w x x),
// by Newton's method with the exact tangent K + M W (derivative of -r; relative equilibrium as in Simo,
// Posbergh and Marsden 1990) rotates rigidly for ever. Translation along w and rotation about w are free: the
// least-norm step leaves them unchanged.
//
// Exact answer: E' = sym(F^T F') = 0, so an objective stiffness damping dissipates nothing, and angular
// momentum H = sum m x x v and energy T + U are constant. Measured: their drift over 2 revolutions, limit
// 1e-9.
//
// The implicit midpoint rule has relative equilibria at any step h, different from the continuous ones. Let
// the shape S be that of the continuous body at spin w (about z), tan(th/2) = w h/2, and let q_n = R(n th) q,
// u_n = w x q_n, where q is S with its part across the axis enlarged by 1/cos(th/2), rotated by -th/2. Then
// q_m = (q_0 + q_1)/2 = S, u_m = w x S, and
//     (q_1 - q_0)/h = (2/h) tan(th/2) e_z x S = u_m,   M (u_1 - u_0)/h = M w x (w x S) = f(S),
// while the strain rate of a rigid spin, and with it the damping, is zero. So the rule also rotates this body
// rigidly for ever, at every step size, and conserves energy and momentum to Newton's tolerance: a residual
// r of a step adds h sum x_m x r to H and h u_m . r to the energy. A correction left at newton_rtol (relative
// to the speeds) may add up over the steps: 2 revolutions of 32 steps are safe at newton_rtol = 1e-9/64,
// about 1e-11. The measured drift is smaller, since Newton's method converges quadratically and ends below
// its tolerance: 4e-9 at newton_rtol = 1e-4, 1e-11 at 1e-6, 6e-13 at 1e-8, rounding at 1e-11. Started in the
// continuous equilibrium instead, the shape oscillates, and the energy, which the rule conserves only for
// quadratic systems, varies by about (w h)^2/8 (4e-3 here), while H is constant.
//
// For any state, internal forces have zero resultant and zero moment (P F^T symmetric), and damping has zero
// power under v = w x x; limit 1e-12, rounding.

namespace palpate::validation {
namespace {

constexpr double kBeta = 1e-3;  // Stiffness damping [s].
const Vec3 kSpin(0.0, 0.0, 40.0);

/// Flat free block, one node block of a State.
struct Spinner {
  TetMesh rest = mesh::perturbed(mesh::box(Vec3(0.10, 0.08, 0.04), {3, 2, 2}), 0.15, 5);
  VecX mass;  ///< One entry per direction.
  dynamics::State state;
  dynamics::System system;
  std::shared_ptr<fem::SoftBody> body;
  std::string fault;

  explicit Spinner(const std::string& its_fault) : fault(its_fault) {
    fem::Material m;
    m.youngs_modulus = 5e4;
    m.poissons_ratio = 0.4;
    m.stiffness_damping = kBeta;
    if (fault == "mass-damping") m.mass_damping = 0.1;
    const VecX masses = fem::lumped_masses(rest, m.density);
    rest.nodes.colwise() -= Vec3(rest.nodes * masses / masses.sum());
    mass = masses.transpose().replicate(3, 1).reshaped();
    dynamics::BlockSpec spec;
    spec.name = "spinner";
    spec.q_size = spec.u_size = static_cast<int>(mass.size());
    spec.q_scale = 0.1;
    spec.u_scale = 0.1 * kSpin.norm();
    const int id = state.insert(spec, rest.nodes.reshaped(), VecX::Zero(mass.size()));
    body = std::make_shared<fem::SoftBody>("spinner", rest, m, fem::SoftBodyOptions{}, id);
    std::shared_ptr<dynamics::ForceTerm> term = body;
    if (fault == "rayleigh-damping") term = with_rayleigh_damping(body, rest.nodes.reshaped(), kBeta);
    if (fault == "small-strain") term = small_strain(body, rest.nodes.reshaped());
    system.add(term);
    system.add(fem::make_lumped_mass(rest, m.density, id));
    system.prepare(state.view());
  }

  /// Returns the spec that is used for a requested one: changed by a fault.
  IntegratorSpec given(IntegratorSpec spec) const {
    if (fault == "tolerance-ignored") spec.rtol = spec.newton_rtol = 1e-4;
    if (fault == "first-order-rule" && spec.name == "implicit-midpoint") spec.name = "backward-euler";
    return spec;
  }

  static VecX spin(const Vec3& w, const VecX& x) {
    return (cross_matrix(w) * x.reshaped(3, x.size() / 3)).reshaped();
  }

  /// Applies Newton's method from the rest shape; returns false if it does not converge to rounding.
  bool find_equilibrium() {
    VecX x = state.q();
    const VecX still = VecX::Zero(x.size());
    const Mat3 W = cross_matrix(kSpin) * cross_matrix(kSpin);
    dynamics::BorderedMatrix K;
    double residual = 1.0;
    for (int i = 0; i < 30 && residual > 1e-14; ++i) {
      const auto at = state.view(0.0, x.data(), still.data());
      VecX f = VecX::Zero(x.size());
      body->add_force(at, f);
      const VecX centrifugal = mass.cwiseProduct(VecX((W * x.reshaped(3, x.size() / 3)).reshaped()));
      const VecX r = f - centrifugal;
      system.step_matrix(at, 0.0, 0.0, 1.0, K);
      MatX J = K.to_dense();
      for (int n = 0; n < x.size() / 3; ++n) J.block<3, 3>(3 * n, 3 * n) += mass[3 * n] * W;
      Eigen::CompleteOrthogonalDecomposition<MatX> solver;
      solver.setThreshold(1e-10);
      solver.compute(J);
      x += solver.solve(r);
      residual = r.norm() / centrifugal.norm();
    }
    state.q() = x;
    return residual < 1e-12;
  }

  Vec3 angular_momentum() {
    Vec3 H = Vec3::Zero();
    for (int i = 0; i < mass.size() / 3; ++i)
      H += mass[3 * i] * state.q().segment<3>(3 * i).cross(state.u().segment<3>(3 * i));
    return H;
  }
  double energy() { return system.kinetic_energy(state.view()) + system.potential_energy(state.view()); }
};

/// Moves the nodes from the shape of the continuous relative equilibrium to the shape for the implicit
/// midpoint rule at step h.
void place_for_midpoint(Spinner& s, double h) {
  const double t = 0.5 * kSpin.z() * h;  // tan(th/2)
  for (Eigen::Index i = 0; i < s.state.q().size(); i += 3) {
    const Vec3 S = s.state.q().segment<3>(i);
    // Rotated by -th/2, components across the axis divided by cos(th/2).
    s.state.q().segment<3>(i) = Vec3(S.x() + t * S.y(), S.y() - t * S.x(), S.z());
  }
}

struct Drift {
  double momentum = 0.0, energy = 0.0;  ///< Largest relative drift.
};

/// Returns the largest drift of angular momentum and energy over `revolutions`, with 8 samples per
/// revolution.
Drift drift(Spinner& s, const IntegratorSpec& spec, int revolutions) {
  constexpr int kSamples = 8;
  s.state.u() = Spinner::spin(kSpin, s.state.q());
  const Vec3 H0 = s.angular_momentum();
  const double E0 = s.energy();
  const auto stepper = integrate::make_stepper(s.system, s.state, s.given(spec));
  Drift out;
  for (int i = 1; i <= revolutions * kSamples; ++i) {
    if (!stepper->advance_to(i * 2.0 * M_PI / (kSamples * kSpin.norm())).ok())
      return {std::nan(""), std::nan("")};
    out.momentum = std::max(out.momentum, (s.angular_momentum() - H0).norm() / H0.norm());
    out.energy = std::max(out.energy, std::abs(s.energy() - E0) / E0);
  }
  return out;
}

void add_drifts(const std::string& fault, std::vector<Measurement>& out) {
  const auto add = [&](const IntegratorSpec& spec, const std::string& note, bool midpoint) {
    Spinner s(fault);
    const bool found = s.find_equilibrium();
    if (midpoint) place_for_midpoint(s, spec.step_s);
    Drift d = drift(s, spec, 2);
    if (!found) d = {std::nan(""), std::nan("")};
    out.push_back({.quantity = "drift of angular momentum, 2 revolutions, " + spec.name,
                   .computed = d.momentum,
                   .error = d.momentum,
                   .bar = 1e-9,
                   .note = note});
    out.push_back({.quantity = "drift of energy, 2 revolutions, " + spec.name,
                   .computed = d.energy,
                   .error = d.energy,
                   .bar = 1e-9,
                   .note = note});
  };
  IntegratorSpec spec;
  spec.rtol = 1e-10;  // The tightest; its error test uses 1e-12.
  add(spec, "rtol 1e-10, stiffness damping on", false);
  spec.name = "implicit-midpoint";
  spec.step_s = 2.0 * M_PI / (32 * kSpin.norm());
  spec.newton_rtol = 1e-11;
  add(spec, "32 steps per revolution, newton_rtol 1e-11, stiffness damping on", true);
}

/// Measures, over random states, the moment of all internal forces, and the power of damping under a rigid
/// spin, relative to the power that the same speeds dissipate in shear.
void add_instantaneous(const std::string& fault, std::vector<Measurement>& out) {
  Spinner s(fault);
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto random = [&](Eigen::Index n) {
    return VecX(VecX::NullaryExpr(n, [&] { return uniform(engine); }));
  };
  double moment = 0.0, power = 0.0;
  for (int k = 0; k < 20; ++k) {
    const VecX x = s.rest.nodes.reshaped() + 0.004 * random(s.mass.size()), v = random(s.mass.size());
    const auto forces = [&](const VecX& velocity) {
      VecX f;
      s.system.force(s.state.view(0.0, x.data(), velocity.data()), f);
      return f;
    };
    const VecX f = forces(v), still = forces(VecX::Zero(x.size()));
    Vec3 sum = Vec3::Zero();
    double size = 0.0;
    for (int i = 0; i < x.size() / 3; ++i) {
      sum += x.segment<3>(3 * i).cross(f.segment<3>(3 * i));
      size += x.segment<3>(3 * i).norm() * f.segment<3>(3 * i).norm();
    }
    moment = std::max(moment, sum.norm() / size);
    const VecX spin = Spinner::spin(50.0 * random(3), x);
    const double speed_ratio = spin.norm() / v.norm();
    const double reference = std::abs(v.dot(f - still)) * speed_ratio * speed_ratio;
    power = std::max(power, std::abs(spin.dot(forces(spin) - still)) / reference);
  }
  out.push_back({.quantity = "moment of internal forces / sum |x||f|, 20 random states",
                 .computed = moment,
                 .error = moment,
                 .bar = 1e-12});
  out.push_back({.quantity = "damping power under v = w x x / damping power of random velocities of equal "
                             "speed",
                 .computed = power,
                 .error = power,
                 .bar = 1e-12});
}

std::vector<Measurement> run(const std::string& fault) {
  std::vector<Measurement> out;
  add_drifts(fault, out);
  add_instantaneous(fault, out);
  return out;
}

}  // namespace

ValidationCase spinning_body() {
  return {
      .name = "spinning-body",
      .section = "D",
      .summary =
          "free soft body spinning in relative equilibrium, stiffness damping on: conservation of angular "
          "momentum and energy",
      .why =
          "damping that is not objective brakes every rotating body; relative equilibrium by Newton (Simo, "
          "Posbergh, Marsden 1990)",
      .quick = true,
      .run = run,
      .faults = {{"mass-damping", "drift of angular momentum"},
                 {"rayleigh-damping", "damping power"},
                 {"small-strain", "moment of internal forces"},
                 {"tolerance-ignored", "drift of energy"},
                 {"first-order-rule", "revolutions, implicit-midpoint"}}};
}

}  // namespace palpate::validation
