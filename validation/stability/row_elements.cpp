#include <cmath>

#include "linear.h"
#include "palpate/mesh/generators.h"

// The clamped block of row_material.cpp, moved by the element code: forces, tangents and damping of a soft
// body with held nodes, displaced by 1e-5 of its size, where corotational elements are linear. Expectations
// follow from linear_theory.cpp, with the stiffness at rest alone.

namespace palpate::stability {
namespace {

constexpr double kDampingRatio = 0.05, kH = 0.01;

SubCase block_case(std::string name, double youngs_modulus, double poissons_ratio,
                   double damping_ratio = kDampingRatio) {
  fem::Material material;
  material.youngs_modulus = youngs_modulus;
  material.poissons_ratio = poissons_ratio;
  material.density = 1000.0;
  return linear_case(
      std::move(name),
      [=] {
        return LinearProblem(mesh::box(Vec3::Constant(1.0), {1, 1, 1}), material, damping_ratio, -0.4)
            .by_elements();
      },
      kH);
}

}  // namespace

Row elements_row() {
  Row row{
      "elements",
      "the clamped block with the code of the elements, E from 1e3 to 1e9 Pa at H = 10 ms, displaced by "
      "1e-5, against the exact motion and the formula of the method.  Detects inconsistent forces, tangents "
      "and damping, and steps that modify them"};
  for (int decade = 3; decade <= 9; decade += 2)
    row.cases.push_back(block_case(fmt::format("E = 1e{} Pa", decade), std::pow(10.0, decade), 0.3));
  row.cases.push_back(block_case("nu = 0.49", 1e5, 0.49));
  row.cases.push_back(block_case("undamped", 1e4, 0.3, 0.0));
  row.core = 1;
  return row;
}

}  // namespace palpate::stability
