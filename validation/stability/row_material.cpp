#include <memory>

#include "linear.h"
#include "palpate/mesh/generators.h"

// A cube of 1 m clamped below, five tetrahedra. Expectations for each column follow from w H and the damping
// ratio of every mode: linear_theory.cpp.

namespace palpate::stability {
namespace {

constexpr double kDampingRatio = 0.05;  // Damping ratio of the lowest mode.

fem::Material material(double youngs_modulus, double poissons_ratio) {
  fem::Material m;
  m.youngs_modulus = youngs_modulus;
  m.poissons_ratio = poissons_ratio;
  m.density = 1000.0;
  return m;
}

SubCase block_case(std::string name, double youngs_modulus, double poissons_ratio, double H,
                   double damping_ratio = kDampingRatio) {
  return linear_case(
      std::move(name),
      [=] {
        return LinearProblem(mesh::box(Vec3::Constant(1.0), {1, 1, 1}),
                             material(youngs_modulus, poissons_ratio), damping_ratio, -0.4);
      },
      H);
}

}  // namespace

Row youngs_modulus_row() {
  Row row{"youngs-modulus",
          "E from 1e3 to 1e11 Pa at H = 10 ms: a clamped block, every mode excited, against the exact motion "
          "and, at fixed steps, the formula of the method.  Detects a step that differs from the method's, "
          "growth, and violated limits"};
  for (int decade = 3; decade <= 11; ++decade)
    row.cases.push_back(block_case(fmt::format("E = 1e{} Pa", decade), std::pow(10.0, decade), 0.3, 0.01));
  row.core = 4;
  return row;
}

Row poissons_ratio_row() {
  Row row{"poissons-ratio",
          "nu from 0.3 to 0.4999 at E = 1e5 Pa, H = 10 ms: the same block.  Detects the same with strongly "
          "different stiffnesses"};
  for (const double nu : {0.3, 0.4, 0.45, 0.49, 0.499, 0.4999})
    row.cases.push_back(block_case(fmt::format("nu = {}", nu), 1e5, nu, 0.01));
  row.core = 2;
  return row;
}

Row undamped_row() {
  Row row{"undamped",
          "the same block without any damping, E from 1e3 to 1e7 Pa at H = 10 ms: its energy is constant.  "
          "Detects damping and growth that the method does not have"};
  for (int decade = 3; decade <= 7; ++decade)
    row.cases.push_back(
        block_case(fmt::format("E = 1e{} Pa", decade), std::pow(10.0, decade), 0.3, 0.01, 0.0));
  row.core = 2;
  return row;
}

Row step_row() {
  Row row{"step",
          "H from 1e-4 to 1 s at E = 1e5 Pa: the same block.  Detects errors that depend on the step size"};
  for (const double H : {1e-4, 1e-3, 1e-2, 1e-1, 1.0})
    row.cases.push_back(block_case(fmt::format("H = {:g} s", H), 1e5, 0.3, H));
  row.core = 2;
  return row;
}

}  // namespace palpate::stability
