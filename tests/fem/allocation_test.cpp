#include <cstdlib>

#include "fem_fixture.h"
#include "malloc_count.h"
#include "palpate/core/workers.h"
#include "palpate/dynamics/zero_row_sum_matrix.h"
#include "palpate/fem/nodal_dilatation.h"

using namespace palpate;
using namespace palpate::fem;
using namespace palpate::fem::testing;

TEST(Allocation, EvaluationsAllocateNothingOnceWarm) {
#if PALPATE_CAN_COUNT
  workers::set_count(2);
  const TetMesh rest = jittered_cube(8, 0.1, 71);
  Random random(72);
  // includes inverted elements
  const VecX x = flat(rest.nodes) + 0.07 * random.vector(3 * rest.nodes.cols()), v = random.vector(x.size());
  OneBody at(x, v);
  Material material = soft_material();
  material.stiffness_damping = 0.1;
  material.mass_damping = 0.1;
  Materials materials({material, soft_material()},
                      std::vector<int>(static_cast<std::size_t>(rest.tets.cols()), 0));
  for (std::size_t e = 0; e < materials.of_element.size(); e += 3) materials.of_element[e] = 1;
  const long before_all = malloc_calls;
  const auto mass = make_consistent_mass(rest, materials, at.id);
  EXPECT_GT(malloc_calls, before_all);  // the counter works
  struct Choice {
    Tangent tangent;
    const char* law;
  };
  for (const auto& [tangent, law] : {Choice{Tangent::kExact, "corotational"},
                                     {Tangent::kProjected, "corotational"},
                                     {Tangent::kWarped, "corotational"},
                                     {Tangent::kExact, "stable_neo_hookean"},
                                     {Tangent::kProjected, "stable_neo_hookean"}}) {
    SoftBody body("b", rest, materials, {.tangent = tangent, .full_damping_tangent = true, .law = law},
                  at.id);
    NodalDilatation dilatation("b", rest, materials,
                               {.tangent = tangent, .full_damping_tangent = true, .volumetric_share = 0.5},
                               at.id);
    dynamics::PatternBuilder builder(at.state.layout());
    dilatation.add_pattern(builder);  // the pattern includes the element's pairs
    dynamics::BorderedMatrix A;
    A.body = builder.build();
    VecX f = VecX::Zero(x.size()), y = f;
    SoftBody symmetric("b", rest, materials, {.tangent = tangent, .law = law}, at.id);
    dynamics::ZeroRowSumMatrix matrix;
    matrix.pattern = &A.body;
    for (int s = 0; s < A.body.slot_count(); ++s) matrix.slot_map.push_back(s);  // more room than needed
    matrix.values.resize(9 * matrix.slot_map.size());
    matrix.diagonal = f;
    matrix.slot_map_key = 1;
    const auto evaluate = [&] {
      for (dynamics::ForceTerm* term : std::initializer_list<dynamics::ForceTerm*>{&body, &dilatation}) {
        term->add_force(at.state.view(), f);
        term->add_tangent(at.state.view(), 1, 1, A);
        term->apply_tangent(at.state.view(), 1, 1, v, y);
        term->energy(at.state.view());
        term->dissipated_power(at.state.view());
      }
      symmetric.add_step(at.state.view(), v, 1, 1, f, matrix);
      symmetric.add_step_force(at.state.view(), v, v, f);
      mass->add_mass(at.state.view(), 1.0, A);
      mass->apply(at.state.view(), v, y);
    };
    evaluate();
    const long warm = malloc_calls;
    evaluate();
    EXPECT_EQ(malloc_calls - warm, 0);
    EXPECT_GT(body.counts().inverted, 0);
  }
  workers::set_count(1);
#else
  GTEST_SKIP() << "a sanitizer owns malloc: nothing can be counted here";
#endif
}
