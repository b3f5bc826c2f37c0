#include <algorithm>
#include <cmath>

#include "core/clock.h"
#include "dynamics/mixed_precision_step.h"
#include "palpate/core/error.h"
#include "palpate/dynamics/state.h"
#include "palpate/fem/soft_body.h"
#include "palpate/integrate/integrators.h"
#include "palpate/linear/solvers.h"
#include "palpate/mesh/generators.h"
#include "product/fem.h"
#include "product/fem/beam.h"

namespace palpate::bench {
namespace {

using namespace dynamics;

constexpr double kBent = 0.8;  ///< [rad] over the length.
constexpr double kDamping = 0.01, kMass = 1.0, kStiffness = 1e-6, kRate = 1e-3;
constexpr int kFewestRuns = 9;

/// Beam bent to a circle, with moving nodes.
struct Bent {
  TetMesh mesh;
  State state;
  VecX shift, force;
  int id = 0;
  explicit Bent(const BeamSize& size) : mesh(beam_mesh(size.along, size.across)) {
    VecX x = mesh.nodes.reshaped();
    for (Eigen::Index i = 0; i < x.size(); i += 3) {
      const double angle = kBent * (x[i] + 0.5), radius = 1.0 / kBent + x[i + 2];
      x[i] = radius * std::sin(angle);
      x[i + 2] = radius * std::cos(angle);
    }
    shift.resize(x.size());
    for (Eigen::Index i = 0; i < x.size(); ++i)
      shift[i] = 1e-3 * std::sin(3.0 * x[i] + static_cast<double>(i % 3));
    force.setZero(x.size());
    id = state.insert(
        BlockSpec{.name = "beam", .q_size = static_cast<int>(x.size()), .u_size = static_cast<int>(x.size())},
        x, shift);
  }
  fem::SoftBody body(fem::Tangent tangent, double damping) const {
    fem::Material material{.youngs_modulus = 1e6, .poissons_ratio = 0.4, .density = 1000.0};
    material.stiffness_damping = damping;
    return {"beam", mesh, material, fem::SoftBodyOptions{.tangent = tangent}, id};
  }
};

}  // namespace

std::vector<ElementTiming> time_elements(const BeamSize& size, double time_s) {
  Bent beam(size);
  std::vector<ElementTiming> out;
  const auto time = [&](const std::string& stage, auto&& run) {
    run();  // Creates maps and memory.
    std::vector<double> ms;
    for (const double start = wall_seconds();
         static_cast<int>(ms.size()) < kFewestRuns || wall_seconds() - start < time_s;) {
      const double before = wall_seconds();
      run();
      ms.push_back(1e3 * (wall_seconds() - before));
    }
    std::sort(ms.begin(), ms.end());
    out.push_back({.size = size.name,
                   .stage = stage,
                   .nodes = static_cast<int>(beam.mesh.nodes.cols()),
                   .tetrahedra = static_cast<int>(beam.mesh.tets.cols()),
                   .runs = static_cast<int>(ms.size()),
                   .least_ms = ms.front(),
                   .median_ms = ms[ms.size() / 2]});
  };
  const StateView at = beam.state.view();
  {
    fem::SoftBody damped = beam.body(fem::Tangent::kWarped, kDamping);
    time("force, damped", [&] { damped.add_force(at, beam.force); });
  }
  fem::SoftBody body = beam.body(fem::Tangent::kWarped, 0.0);
  time("force", [&] { body.add_force(at, beam.force); });
  time("residual", [&] { body.add_step_force(at, beam.shift, beam.shift, beam.force); });
  PatternBuilder pattern(beam.state.layout());
  body.add_pattern(pattern);
  BorderedMatrix A;
  A.body = pattern.build();
  {
    const auto solver = linear::make_linear_solver("pcg-single", {.linear_rtol = 1e-3});
    auto& mixed = dynamic_cast<MixedPrecisionSolver&>(*solver);
    ZeroRowSumMatrix* room = mixed.step_matrix(A.body);
    PALPATE_CHECK(room, "pcg-single has no room for a step matrix");
    room->diagonal = VecX::Constant(beam.force.size(), kMass);
    time("fused assembly", [&] { body.add_step(at, beam.shift, kStiffness, kRate, beam.force, *room); });
  }
  time("tangent, warped", [&] { body.store_tangent(at, kStiffness, kRate, A); });
  fem::SoftBody exact = beam.body(fem::Tangent::kExact, 0.0);
  time("tangent, exact", [&] { exact.store_tangent(at, kStiffness, kRate, A); });
  return out;
}

}  // namespace palpate::bench
