#include <random>

#include "faults.h"
#include "palpate/fem/soft_body.h"
#include "palpate/mesh/generators.h"
#include "validation.h"

// The internal forces of a body derive from an energy that is invariant under rigid motion.  Their sum and
// their moment about any point are zero for any deformation (Newton's third law).

namespace palpate::validation {
namespace {

/// A defect of the library: the force of one node is lost.
class LostForce : public DecoratedTerm {
 public:
  using DecoratedTerm::DecoratedTerm;
  void add_force(const dynamics::StateView& state, VecX& f) override {
    const VecX before = f;
    term().add_force(state, f);
    f.head<3>() = before.head<3>();
  }
};

std::vector<Measurement> run(const std::string& fault) {
  const TetMesh rest = mesh::box(Vec3::Constant(0.1), {3, 3, 3});
  const auto n = rest.nodes.cols();
  dynamics::State state(static_cast<int>(3 * n), static_cast<int>(3 * n));
  dynamics::BlockSpec spec;
  spec.q_size = spec.u_size = static_cast<int>(3 * n);
  const int id = state.insert(spec, rest.nodes.reshaped(), VecX::Zero(3 * n));
  std::shared_ptr<dynamics::ForceTerm> body = std::make_shared<fem::SoftBody>(
      "body", rest, fem::Material{.youngs_modulus = 1e4}, fem::SoftBodyOptions{}, id);
  if (fault == "lost-force") body = std::make_shared<LostForce>(body);

  std::mt19937 engine(5);
  std::uniform_real_distribution<double> uniform(-0.01, 0.01);
  const VecX x = rest.nodes.reshaped() + VecX::NullaryExpr(3 * n, [&] { return uniform(engine); }),
             zero = VecX::Zero(3 * n);
  VecX f = zero;
  body->add_force(state.view(0.0, x.data(), zero.data()), f);
  Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
  double sizes = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vec3 at = x.segment<3>(3 * i), force = f.segment<3>(3 * i);
    sum += force;
    moment += at.cross(force);
    sizes += force.norm();
  }
  const double error = sum.norm() / sizes, turning = moment.norm() / (0.1 * sizes);
  return {
      {.quantity = "sum of the forces / sum of their sizes", .computed = error, .error = error, .bar = 1e-12},
      {.quantity = "moment of the forces / size times sum of their sizes",
       .computed = turning,
       .error = turning,
       .bar = 1e-12}};
}

}  // namespace

ValidationCase inner_forces() {
  return {.name = "inner-forces",
          .section = "C",
          .summary = "a deformed body's forces on its own nodes have neither sum nor moment",
          .why = "Newton's third law: else a body would push or turn itself",
          .run = run,
          .faults = {{"lost-force", "of the forces"}}};
}

}  // namespace palpate::validation
