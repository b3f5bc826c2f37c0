#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "b_bodies.h"
#include "cases.h"
#include "images.h"
#include "palpate/core/error.h"
#include "palpate/dynamics/system.h"
#include "palpate/fem/soft_body.h"
#include "palpate/integrate/integrators.h"
#include "palpate/mesh/boundary.h"
#include "palpate/mesh/generators.h"

// Problem: a ball falls on a fixed plane and bounces.
//
// Exact answer (conservation of energy): the plane's normal does not rotate, so each sample's force k A
// max(0, -gap) n is the gradient of k A gap^2/2 with the projected area A. Undamped, kinetic
// energy + weight + contact energy is constant; damped, it falls. It must never rise. Gains are relative to
// the energy of the fall, m g h.
// - Rigid: a point mass that carries the vertices of a sphere as arms (a sphere on a plane does not
//   rotate). Areas are constant, and any energy gained is due to the integrator. Sampled every millisecond,
//   when the contact is queried, as in a scene.
// - Soft: a ball of tetrahedra. The projected areas of its vertices change with its shape, and are constant
//   between two queries (method "analytic"). The energy gained at each query is the cost of infrequent
//   queries: reported without a limit.
//
// Limit: 1e-6. Pairs of order 2 run at rtol 1e-7, the others at 1e-10, which would need thirty times the
// steps with order 2.
//
// Why some pairs locate the kinks as roots. A vertex that touches at the fraction theta of a step changes its
// force by J: y'' = J (t - theta h)+. The step's error in the velocity and its estimate are then
//     J h^2 |sum b_i (c_i - theta)+ - (1 - theta)^2/2|   and   J h^2 |sum (b_i - b^_i) (c_i - theta)+|.
// The error is more than 860 times the estimate for 25 % of all theta with ark-dirk-sdirk534, 13 % with
// -ark548b and 8 % with -ark437, and for less than 0.5 % with every other diagonally implicit pair of order 4
// and 5 (more than 100 times for 25, 19 and 20 %; less than 4). Among additive pairs it is 35 times and more
// for 18 % with ark-imex-4b, 20 times for 18 % (more than 860 times for a tenth) with ark-imex-5b; with Cash
// and Karp's pair, 3 times in the median over theta, and more than 100 times for 0.7 %. A tolerance of 1e-10
// thus misses kinks: by error control alone ark-imex-5b gains 3e-6, at rtol 1e-9 and 1e-10 alike,
// ark-dirk-sdirk534 3.6e-6 and -ark548b 5.5e-6. With the kinks located as roots the steps on both sides are
// smooth, and these pairs meet the limit.

namespace palpate::validation {
namespace {

constexpr double kRadius = 0.02, kDrop = 0.01, kGravity = 9.81, kMass = 0.03;
constexpr double kStiffness = 5e8;             // [Pa/m]: depth about 1 mm, 12 ms of contact
constexpr double kRefresh = 1e-3, kEnd = 0.4;  // [s]: four bounces
constexpr std::array<std::string_view, 3> kBlindToKinks = {"ark-dirk-sdirk534", "ark-dirk-ark548b",
                                                           "ark-dirk-ark437"};

/// Source for the vertices of a sphere carried by one node, over the plane z = 0 of frame 0.
class BallSource final : public contact::SampleSource {
 public:
  explicit BallSource(int node)
      : SampleSource({.name = "ball"}), node_(node), sphere_(mesh::sphere(kRadius, 12)) {
    areas_.setZero(sphere_.vertices.cols());
    for (const auto& face : sphere_.faces.colwise()) {
      const Vec3 a = sphere_.vertices.col(face[0]), b = sphere_.vertices.col(face[1]),
                 c = sphere_.vertices.col(face[2]);
      for (int corner : face) areas_[corner] -= (b - a).cross(c - a).z() / 6.0;
    }
  }
  void add_pattern(dynamics::PatternBuilder&) const override {}
  void query(const dynamics::StateView& state, std::vector<contact::ContactSample>& samples) override {
    const Vec3 x = state.position(node_);
    const double look_ahead = 2.0 * kRefresh * std::max(0.0, -state.velocity(node_).z());
    for (Eigen::Index i = 0; i < areas_.size(); ++i) {
      const Vec3 arm = sphere_.vertices.col(i);
      const double gap = x.z() + arm.z();
      if (areas_[i] <= 0.0 || gap > look_ahead) continue;
      contact::ContactSample sample;
      sample.a.count = 1;
      sample.a.node[0] = node_;
      sample.a.weight[0] = 1.0;
      sample.a.offset = arm;
      sample.b.frame = 0;
      sample.b.offset = Vec3(x.x() + arm.x(), x.y() + arm.y(), 0.0);
      sample.area = areas_[i];
      sample.gap = gap;
      samples.push_back(sample);
    }
  }

 private:
  int node_;
  TriMesh sphere_;
  VecX areas_;
};

/// State, System and contact with the plane; the callers add the ball.
struct Fall {
  dynamics::State state;
  dynamics::System system;
  std::shared_ptr<contact::ContactForce> contact = std::make_shared<contact::ContactForce>();
  ContactSpec law;

  explicit Fall(double damping) {
    law.stiffness_pa_m = kStiffness;
    law.damping_pa_s_m = damping;
    contact->add_frame(contact::fixed_frame());
  }

  struct Outcome {
    double gain = 0.0;     ///< Largest rise of the energy over its start, divided by m g h.
    double deepest = 0.0;  ///< Lowest position of node 0 [m], to show that it bounced.
    long queries = 0;
  };
  Outcome run(const IntegratorSpec& spec, double fall_energy) {
    contact->refresh(state.view());
    system.prepare(state.view());
    const auto stepper = integrate::make_stepper(system, state, spec);
    const auto energy = [&] {
      return system.kinetic_energy(state.view()) + system.potential_energy(state.view());
    };
    const double start = energy();
    Outcome out;
    out.deepest = state.q()[2];
    for (int i = 1; i * kRefresh <= kEnd; ++i) {
      const auto result = stepper->advance_to(i * kRefresh);
      if (!result.ok()) {
        out.gain = std::nan("");
        return out;
      }
      out.gain = std::max(out.gain, (energy() - start) / fall_energy);
      out.deepest = std::min(out.deepest, state.q()[2]);
      if (contact->refresh(state.view())) stepper->reinit(dynamics::ReinitReason::kContactRefreshed);
      out.gain = std::max(out.gain, (energy() - start) / fall_energy);
    }
    out.queries = contact->statistics().queries;
    return out;
  }
};

Fall::Outcome drop_rigid(const IntegratorSpec& spec, double damping, const std::string& fault) {
  Fall fall(damping);
  dynamics::BlockSpec node;
  node.name = "ball";
  node.q_size = node.u_size = 3;
  node.q_scale = 1e-3;
  node.u_scale = std::sqrt(2.0 * kGravity * kDrop);
  const int id = fall.state.insert(node, Vec3(0.0, 0.0, kRadius + kDrop), Vec3::Zero());
  std::unique_ptr<contact::SampleSource> ball = std::make_unique<BallSource>(0);
  if (fault == "no-look-ahead")
    ball = spoiled(std::move(ball),
                   [](auto& samples) { std::erase_if(samples, [](const auto& s) { return s.gap > 0.0; }); });
  fall.contact->add_pair(std::move(ball), fall.law);
  fall.system.add(std::static_pointer_cast<dynamics::ForceTerm>(fall.contact));
  fall.system.add(fem::make_gravity(VecX::Constant(1, kMass), Vec3(0, 0, -kGravity), id));
  fall.system.add(std::make_shared<PointMass>(id, kMass));
  return fall.run(spec, kMass * kGravity * kDrop);
}

Fall::Outcome drop_soft(const IntegratorSpec& spec, double& mass) {
  Fall fall(0.0);
  TetMesh rest = mesh::ball(kRadius, 0.01);
  fem::Material m;
  m.youngs_modulus = 1e5;
  m.poissons_ratio = 0.4;
  const VecX masses = fem::lumped_masses(rest, m.density);
  mass = masses.sum();
  VecX q0 = rest.nodes.reshaped();
  for (Eigen::Index i = 2; i < q0.size(); i += 3) q0[i] += kRadius + kDrop;
  dynamics::BlockSpec nodes;
  nodes.name = "ball";
  nodes.q_size = nodes.u_size = static_cast<int>(q0.size());
  nodes.q_scale = 1e-3;
  nodes.u_scale = std::sqrt(2.0 * kGravity * kDrop);
  const int id = fall.state.insert(nodes, q0, VecX::Zero(q0.size()));
  const mesh::Boundary boundary = mesh::boundary(rest);
  fall.contact->add_pair(
      contact::make_plane_source(contact::NodeSurface{id, boundary.node_of_vertex, boundary.surface.faces}, 0,
                                 contact::fixed_frame(), Vec3::Zero(), Vec3::UnitZ(), 1e-3, 2.0 * kRefresh),
      fall.law);
  fall.system.add(std::make_shared<fem::SoftBody>("ball", rest, m, fem::SoftBodyOptions{}, id));
  fall.system.add(std::static_pointer_cast<dynamics::ForceTerm>(fall.contact));
  fall.system.add(fem::make_gravity(masses, Vec3(0, 0, -kGravity), id));
  fall.system.add(fem::make_lumped_mass(rest, m.density, id));
  return fall.run(spec, mass * kGravity * kDrop);
}

std::vector<Measurement> run(const std::string& fault) {
  using dynamics::StepControl;
  std::vector<Measurement> out;
  IntegratorSpec spec;
  for (const auto& entry : integrate::stepper_registry()) {
    if (entry.traits.control == StepControl::kFixed || entry.traits.stability == dynamics::Stability::kStatic)
      continue;
    spec.name = entry.name;
    // The digits of Cash's tables end at 5e-10: the tolerance is then too coarse for kinks under error
    // control.
    const bool coarse = entry.tightest_rtol(spec) > 1e-10 && entry.traits.order > 2;
    const bool blind =
        entry.traits.family == "ImEx Runge-Kutta" ||
        std::find(kBlindToKinks.begin(), kBlindToKinks.end(), entry.name) != kBlindToKinks.end();
    spec.events = coarse || blind ? KinkTreatment::kRootFinding : KinkTreatment::kErrorControl;
    const double requested = entry.traits.order <= 2 ? 1e-7 : std::max(1e-10, entry.tightest_rtol(spec));
    spec.rtol = fault == "tolerance-ignored" ? 1e-2 : requested;
    spec.max_steps = 100'000'000;
    for (const double damping : {0.0, 2e6}) {
      const Fall::Outcome fall = drop_rigid(spec, damping, fault);
      const bool bounced = fall.deepest < kRadius - 1e-4;
      out.push_back({.quantity = fmt::format("rigid ball, {}, {}: energy gained / m g h",
                                             damping > 0.0 ? "damped" : "undamped", entry.name),
                     .computed = fall.gain,
                     .error = bounced ? fall.gain : std::nan(""),
                     .bar = 1e-6,
                     .note = fmt::format("rtol {:.2g}, {:.2g} mm deep, {} queries", spec.rtol,
                                         1e3 * (kRadius - fall.deepest), fall.queries)});
    }
  }
  if (!fault.empty()) return out;
  spec.name = "cvode-bdf";
  spec.rtol = 1e-6;
  double mass = 0.0;
  const Fall::Outcome soft = drop_soft(spec, mass);
  out.push_back(
      {.quantity = "soft ball, undamped, cvode-bdf: energy gained / m g h",
       .computed = soft.gain,
       .error = soft.gain,
       .bar = std::numeric_limits<double>::infinity(),
       .note = "reported without acceptance limit: projected areas are held between two queries, 1 ms apart; "
               "rtol 1e-6"});
  return out;
}

}  // namespace

ValidationCase dropped_ball() {
  return {
      .name = "dropped-ball",
      .section = "D",
      .summary =
          "a rigid ball bounces on a plane: energy gained by every integrator with error control, with root "
          "finding where the error estimate misses kinks; also a soft ball",
      .why = "spurious energy at contact makes a haptic device kick; conservation of energy",
      .run = run,
      .faults = {{"no-look-ahead", "rigid ball, undamped, cvode-bdf"},
                 {"tolerance-ignored", "rigid ball, undamped, ark-erk-4"}}};
}

}  // namespace palpate::validation
