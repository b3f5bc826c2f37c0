#include <cmath>
#include <functional>
#include <random>

#include "cases.h"
#include "faults.h"
#include "palpate/core/pose.h"
#include "palpate/mesh/generators.h"
#include "statics.h"

// Problem: the force must be minus the gradient of the energy, and the tangent the derivative of the force.
//
// Exact answer (Taylor): |E(x + h w) - E(x) + h f . w| and |f(x + h w) - f(x) + h K w| fall with h^2, down to
// rounding. Measured: this order, accepted from 1.9 to 2.1, and the asymmetry of the tangent, limit 1e-14
// (rounding). Shapes avoid the points at which two signed singular values cancel: R jumps there, and the
// force has no derivative.

namespace palpate::validation {
namespace {

struct Shape {
  const char* name;
  TetMesh rest;
  VecX x;
  double step;  ///< Largest h; smaller for a fine mesh.
};

Mat3 rotated(const Vec3& stretches) {
  return quaternion_of(Vec3(0.4, -1.1, 0.7)).toRotationMatrix() * stretches.asDiagonal() *
         quaternion_of(Vec3(-0.8, 0.3, 1.2)).toRotationMatrix();
}

std::vector<Shape> shapes() {
  std::vector<Shape> out;
  const TetMesh tet = mesh::corner_tet(Vec3(1.0, 1.2, 0.9));
  const std::pair<const char*, Vec3> kinds[] = {{"one element, regular", {1.2, 0.9, 0.8}},
                                                {"one element, flat", {1.1, 0.8, 0.0}},
                                                {"one element, inverted", {1.3, 0.9, -0.4}}};
  for (const auto& [name, stretches] : kinds)
    out.push_back({name, tet, (rotated(stretches) * tet.nodes).reshaped(), 1e-2});
  const TetMesh cube = mesh::perturbed(mesh::box(Vec3::Ones(), {3, 3, 3}), 0.2, 13);
  std::mt19937 engine(14);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  VecX x = (rotated({1.1, 1.0, 0.9}) * cube.nodes).reshaped();
  out.push_back({"mesh, sheared and rotated", cube, x, 2e-3});
  for (auto& value : x) value += 0.15 * uniform(engine);
  out.push_back({"mesh, nodes scattered, elements inverted", cube, x, 1e-4});
  return out;
}

/// Measures the observed order of r(h) over h = step / 2^k, k = 0..6, with the accepted range 1.9 to 2.1.
Measurement taylor(const std::string& quantity, double step, const std::function<double(double)>& remainder) {
  std::vector<double> h, r;
  for (int k = 0; k <= 6; ++k) {
    h.push_back(step / std::pow(2.0, k));
    r.push_back(remainder(h.back()));
  }
  const double order = validation::fitted_order(h, r);
  return {.quantity = quantity,
          .computed = order,
          .exact = 2.0,
          .error = std::abs(order - 2.0),
          .bar = 0.1,
          .order = order,
          .order_low = 1.9,
          .order_high = 2.1,
          .note = "error: absolute error of the order"};
}

/// Adds an unsymmetric part to K: each force depends on the next displacement as well.
class Unsymmetric final : public DecoratedTerm {
 public:
  using DecoratedTerm::DecoratedTerm;
  void apply_tangent(const dynamics::StateView& state, double k, double d, const VecX& x, VecX& y) override {
    term().apply_tangent(state, k, d, x, y);
    y.head(x.size() - 1) += 1e-6 * k * x.tail(x.size() - 1);
  }
};

void measure(const Shape& shape, const std::string& fault, std::vector<Measurement>& out) {
  fem::Material material;
  material.youngs_modulus = 3.0;
  material.poissons_ratio = 0.35;
  const auto n = shape.x.size();
  dynamics::State state(static_cast<int>(n), static_cast<int>(n));
  dynamics::BlockSpec spec;
  spec.q_size = spec.u_size = static_cast<int>(n);
  const VecX zero = VecX::Zero(n);
  const int id = state.insert(spec, shape.x, zero);
  fem::SoftBodyOptions options;
  if (fault == "no-rotation-derivative") options.tangent = fem::Tangent::kWarped;
  std::shared_ptr<dynamics::ForceTerm> body =
      std::make_shared<fem::SoftBody>("body", shape.rest, material, options, id);
  if (fault == "wrong-sign") body = scaled(body, {.force = -1.0});
  if (fault == "half-stiffness") body = scaled(body, {.stiffness = 0.5});
  if (fault == "unsymmetric") body = std::make_shared<Unsymmetric>(body);

  const auto force = [&](const VecX& x) {
    VecX f = VecX::Zero(n);
    body->add_force(state.view(0.0, x.data(), zero.data()), f);
    return f;
  };
  const auto energy = [&](const VecX& x) { return body->energy(state.view(0.0, x.data(), zero.data())); };
  std::mt19937 engine(15);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const VecX w = VecX::NullaryExpr(n, [&] { return uniform(engine); }),
             w2 = VecX::NullaryExpr(n, [&] { return uniform(engine); });
  const VecX f0 = force(shape.x);
  const double e0 = energy(shape.x);
  VecX Kw = VecX::Zero(n), Kw2 = Kw;
  const auto here = state.view(0.0, shape.x.data(), zero.data());
  body->apply_tangent(here, 1.0, 0.0, w, Kw);
  body->apply_tangent(here, 1.0, 0.0, w2, Kw2);

  const std::string name = shape.name;
  out.push_back(taylor(name + ": order of energy + force", shape.step,
                       [&](double h) { return std::abs(energy(shape.x + h * w) - e0 + h * f0.dot(w)); }));
  out.push_back(taylor(name + ": order of force + tangent", shape.step,
                       [&](double h) { return (force(shape.x + h * w) - f0 + h * Kw).norm(); }));
  const double asymmetry = std::abs(w2.dot(Kw) - w.dot(Kw2)) / (w.norm() * Kw2.norm());
  out.push_back({.quantity = name + ": asymmetry of the tangent",
                 .computed = asymmetry,
                 .error = asymmetry,
                 .bar = 1e-14});
}

std::vector<Measurement> run(const std::string& fault) {
  std::vector<Measurement> out;
  for (const Shape& shape : shapes()) measure(shape, fault, out);
  return out;
}

}  // namespace

ValidationCase gradient_and_tangent() {
  return {.name = "gradient-and-tangent",
          .section = "C",
          .summary =
              "the force is minus the gradient of the energy, the exact tangent the derivative of the force; "
              "flat and inverted elements too",
          .why =
              "energy is conserved and Newton converges only if both hold; finite differences are "
              "independent of the derivation",
          .quick = true,
          .run = run,
          .faults = {{"wrong-sign", "energy + force"},
                     {"half-stiffness", "force + tangent"},
                     {"no-rotation-derivative", "sheared and rotated: order of force + tangent"},
                     {"unsymmetric", "asymmetry"}}};
}

}  // namespace palpate::validation
