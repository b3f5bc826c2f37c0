#include <cmath>

#include "cases.h"
#include "contact/sources.h"
#include "images.h"
#include "palpate/contact/contact_force.h"
#include "palpate/core/error.h"
#include "palpate/dynamics/system.h"
#include "palpate/fem/attachments.h"
#include "palpate/fem/soft_body.h"
#include "palpate/integrate/integrators.h"
#include "palpate/mesh/boundary.h"
#include "palpate/mesh/generators.h"

// Problem: a rigid sphere on a prescribed path is pressed into a soft block and dragged over it. Between two
// queries, an interval H apart, the gap of a sample that does not follow the state (as with images) is linear
// in the positions: normal, area and foot point remain those found by the query.
//
// Expected order in H (one-step error analysis). At the time s after a query the point has moved along the
// sphere by v s, the normal has turned by v s/R, and the gap along the old normal has the error (v s)^2/(2
// R). The force, p A n, has a first-order error F' s (through n and A) and a second-order one. Over an
// interval the first leaves an impulse F' H^2/2, and over all intervals F' H T/2 with constant sign:
// positions converge with order 1 in H for any integrator. Measured: this order, accepted from 0.8 to 1.2.
//
// (A method with order 1 and steps h evaluates the force only at the beginnings or ends of its steps: its
// samples are older by (H - h)/2 or (H + h)/2 on average, so h must be a small part of H for the order to
// show.)
//
// Where samples follow the state, the force is a function of the state and the refresh contributes no error.
// The remaining error is the integrator's, with the order of its steps (accepted: +/- 0.2). No new candidates
// appear (the candidate gap is as large as the path), and the pressure sets in smoothly, so that no other
// error is measured.

namespace palpate::validation {
namespace {

constexpr double kRadius = 0.015, kHeight = 0.005, kEnd = 0.02, kDepth = 1.5e-3, kWay = 6e-3;
constexpr double kPi = 3.14159265358979323846;
constexpr double kOutput = 2e-3;

/// Path down and along x, both by s(t) = sin^2(pi t/(2 T)).
class PathFrame final : public contact::MovingFrame {
 public:
  Pose pose(const dynamics::StateView& state) const override {
    const double s = std::pow(std::sin(0.5 * kPi * state.time / kEnd), 2);
    return {Quat::Identity(), Vec3(kWay * (s - 0.5), 1e-3, kRadius + 0.5 * kHeight + 2e-4 - kDepth * s)};
  }
  Twist twist(const dynamics::StateView& state) const override {
    const double rate = 0.5 * kPi / kEnd * std::sin(kPi * state.time / kEnd);
    return {Vec3::Zero(), Vec3(kWay * rate, 0.0, -kDepth * rate)};
  }
};

/// Source that claims to follow the state but keeps the samples from its last query: the library without
/// following.
class StaleSource final : public contact::SampleSource {
 public:
  explicit StaleSource(std::unique_ptr<contact::SampleSource> source)
      : SampleSource({.name = source->traits().name, .follows = true}), source_(std::move(source)) {}
  void query(const dynamics::StateView& state, std::vector<contact::ContactSample>& samples) override {
    source_->query(state, samples);
  }
  void add_pattern(dynamics::PatternBuilder& pattern) const override { source_->add_pattern(pattern); }

 private:
  std::unique_ptr<contact::SampleSource> source_;
};

/// Source that returns the samples of its first query at every later query.
class OnceSource final : public contact::SampleSource {
 public:
  explicit OnceSource(std::unique_ptr<contact::SampleSource> source)
      : SampleSource({.name = source->traits().name, .follows = source->traits().follows}),
        source_(std::move(source)) {}
  void query(const dynamics::StateView& state, std::vector<contact::ContactSample>& samples) override {
    if (first_.empty()) source_->query(state, first_);
    samples.insert(samples.end(), first_.begin(), first_.end());
  }
  void add_pattern(dynamics::PatternBuilder& pattern) const override { source_->add_pattern(pattern); }
  void follow(const dynamics::StateView& state, std::span<contact::ContactSample> samples) override {
    source_->follow(state, samples);
  }

 private:
  std::unique_ptr<contact::SampleSource> source_;
  std::vector<contact::ContactSample> first_;
};

/// Displacements [m] of all nodes at all output times, concatenated.
using Track = std::vector<double>;

double distance(const Track& a, const Track& b) {
  PALPATE_CHECK(a.size() == b.size(), "{} displacements against {}", a.size(), b.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

Track drag(const IntegratorSpec& spec, double refresh, bool follows, const std::string& fault) {
  const TetMesh rest = mesh::box(Vec3(0.02, 0.02, kHeight), {4, 4, 1});
  fem::Material material;
  material.youngs_modulus = 2e4;
  material.stiffness_damping = 1e-3;
  dynamics::State state;
  dynamics::BlockSpec nodes;
  nodes.name = "block";
  nodes.q_size = nodes.u_size = static_cast<int>(rest.nodes.size());
  nodes.q_scale = kDepth;
  nodes.u_scale = kDepth / kEnd;
  const int id = state.insert(nodes, rest.nodes.reshaped(), VecX::Zero(rest.nodes.size()));
  dynamics::System system;
  system.add(std::make_shared<fem::SoftBody>("block", rest, material, fem::SoftBodyOptions{}, id));
  system.add(fem::make_lumped_mass(rest, material, id));
  std::vector<int> held;
  for (int i = 0; i < rest.nodes.cols(); ++i)
    for (int axis = 0; axis < 3 && rest.nodes(2, i) < 0.0; ++axis) held.push_back(3 * i + axis);
  system.add(fem::make_fixed(held, VecX(state.q()(held))));
  const auto contact = std::make_shared<contact::ContactForce>();
  const auto motion = std::make_shared<PathFrame>();
  contact->add_frame(motion);
  ContactSpec law;
  law.stiffness_pa_m = 2e7;
  law.onset_width_m = 2e-4;
  const mesh::Boundary boundary = mesh::boundary(rest);
  const contact::NodeSurface surface{id, boundary.node_of_vertex, boundary.surface.faces};
  auto source =
      contact::make_sphere_source(contact::material_points(surface, boundary.surface.vertices, rest, kRadius),
                                  0, motion, Vec3::Zero(), kRadius, 2.0 * kRadius);
  if (fault == "samples-stay" && follows) source = std::make_unique<StaleSource>(std::move(source));
  if (!follows) source = validation::held(std::move(source));
  if (fault == "one-query") source = std::make_unique<OnceSource>(std::move(source));
  contact->add_pair(std::move(source), law);
  system.add(std::static_pointer_cast<dynamics::ForceTerm>(contact));
  contact->refresh(state.view());
  system.prepare(state.view());
  const auto stepper = integrate::make_stepper(system, state, spec);
  Track out;
  const int intervals = static_cast<int>(std::lround(kEnd / refresh)),
            every = static_cast<int>(std::lround(kOutput / refresh));
  for (int i = 1; i <= intervals; ++i) {
    if (!stepper->advance_to(i * refresh).ok()) return {};
    if (i % every == 0)
      for (Eigen::Index k = 0; k < state.q().size(); ++k)
        out.push_back(state.q()[k] - rest.nodes.reshaped()[k]);
    if (contact->refresh(state.view())) stepper->reinit(dynamics::ReinitReason::kContactRefreshed);
  }
  return out;
}

struct Method {
  const char* name;
  bool fixed;    ///< Steps of at most kStep; otherwise error control.
  double order;  ///< Order for fixed steps.
};
constexpr double kStep = 1e-4, kFineStep = 2.5e-5, kTolerance = 1e-7;
constexpr Method kMethods[] = {{"cvode-bdf", false, 0},
                               {"ida", false, 0},
                               {"ark-dirk-esdirk436", false, 0},
                               {"ark-erk-4", false, 0},
                               {"linearly-implicit-euler", true, 1},
                               {"implicit-midpoint", true, 2},
                               {"symplectic-euler", true, 1},
                               {"ark-mri-2", true, 2}};

IntegratorSpec spec_of(const Method& method, double step) {
  IntegratorSpec spec;
  spec.name = method.name;
  spec.rtol = kTolerance;
  spec.step_s = step;
  return spec;
}

std::vector<Measurement> run(const std::string& fault) {
  IntegratorSpec tight;
  tight.name = "ark-dirk-ark548";
  tight.rtol = 1e-10;
  const Track reference = drag(tight, kOutput, true, "");
  const double moved = distance(reference, Track(reference.size(), 0.0));
  std::vector<Measurement> out;
  for (const Method& method : kMethods) {
    if (!fault.empty() && &method != kMethods) break;  // One method suffices for a fault.
    Measurement own{.quantity = fmt::format("{}, exact gaps: error / displacement", method.name),
                    .bar = 1e2 * kTolerance};
    std::vector<double> step, errors;
    Track exact;
    for (const double h :
         method.fixed ? std::vector<double>{kStep, 0.5 * kStep, kFineStep} : std::vector<double>{kFineStep}) {
      step.push_back(h);
      exact = drag(spec_of(method, h), kOutput, true, fault);
      errors.push_back(distance(exact, reference) / moved);
    }
    own.error = own.computed = errors.back();
    if (method.fixed) {
      own.bar = 1e-2;
      own.order = validation::fitted_order(step, errors);
      own.order_low = method.order - 0.2;
      own.order_high = method.order + 0.2;
      own.note = "error of the integrator: order in its step";
      own.refinement = {"step [s]", step, errors};
    }
    out.push_back(own);
    std::vector<double> refresh, error;
    for (const double interval : {1e-3, 5e-4, 2.5e-4}) {
      refresh.push_back(interval);
      error.push_back(distance(drag(spec_of(method, kFineStep), interval, false, fault), exact) / moved);
    }
    out.push_back(
        {.quantity = fmt::format("{}: error of a refresh every 0.25 ms / displacement", method.name),
         .computed = error.back(),
         .error = error.back(),
         .bar = 2e-2,
         .order = validation::fitted_order(refresh, error),
         .order_low = 0.8,
         .order_high = 1.2,
         .note = "against exact gaps in the same integrator; order in the refresh interval",
         .refinement = {"refresh interval [s]", refresh, error}});
  }
  return out;
}

}  // namespace

ValidationCase contact_refresh() {
  return {
      .name = "contact-refresh",
      .section = "B",
      .summary =
          "a sphere dragged over a soft block: order of the error in the refresh interval in every family of "
          "integrators, and the error of the integrator with exact gaps",
      .why =
          "the error of a slow query must be known separately from that of the integrator: first order, "
          "because normals and areas are held between two queries (one-step error analysis)",
      .quick = true,
      .run = run,
      .faults = {{"samples-stay", "exact gaps"}, {"one-query", "error of a refresh"}}};
}

}  // namespace palpate::validation
