// Uses the installed parts in the way of a simulator: SUNDIALS inside palpate::integrate and CPodes inside
// Simbody, in one process, in the order given by the argument; a soft body's mass; one tick of a tool.
#include <cmath>
#include <cstdio>
#include <string>

#include "cpodes.h"
#include "palpate/fem/soft_body.h"
#include "palpate/integrate/integrators.h"
#include "palpate/integrate/self_test.h"
#include "palpate/tool/tool.h"

namespace {

int failures = 0;

void expect_near(const char* what, double computed, double exact, double bar) {
  const bool right = std::abs(computed - exact) <= bar;
  std::printf("%s: %.10g, exactly %.10g: %s\n", what, computed, exact, right ? "right" : "WRONG");
  failures += right ? 0 : 1;
}

void cpodes() { expect_near("CPodes", cpodes_decay(1.0), std::exp(-1.0), 1e-6); }

void sundials() {
  for (const auto& answer : palpate::integrate::self_test::all(1.0))
    expect_near(answer.library.c_str(), answer.y, std::exp(-1.0), 1e-6);
}

/// Checks the mass of a body with the volume 1/6 m^3 at 1200 kg/m^3.
void soft_body() {
  palpate::TetMesh tet;
  tet.nodes.resize(3, 4);
  tet.nodes << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  tet.tets.resize(4, 1);
  tet.tets << 0, 1, 2, 3;
  expect_near("mass of a tetrahedron", palpate::fem::lumped_masses(tet, 1200.0).sum(), 200.0, 1e-10);
}

/// Checks a tick without forces: handle and tool are in the same place.
void tool() {
  palpate::tool::Tool tool(palpate::ToolSpec{}, palpate::Vec3::Zero());
  const auto result = tool.advance(1e-3, {}, {});
  expect_near("tool's tick", result.ok() ? tool.pose().translation.norm() : NAN, 0.0, 1e-12);
}

}  // namespace

int main(int argc, char** argv) {
  const bool cpodes_first = argc > 1 && std::string(argv[1]) == "cpodes-first";
  if (cpodes_first) cpodes();
  sundials();
  if (!cpodes_first) cpodes();
  sundials();
  soft_body();
  tool();
  if (palpate::integrate::stepper_registry().empty()) ++failures;
  return failures;
}
