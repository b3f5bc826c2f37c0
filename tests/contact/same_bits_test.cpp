// What the samples' forces may depend on: not on who draws the image.
#include <cstdlib>

#include "two_balls.h"

using namespace contact_tests;

namespace {

struct Felt {
  VecX force;
  std::size_t samples;
};

/// Forces on the nodes of two soft bodies that overlap and slide.
Felt felt_by(contact::DepthBackend which, bool pruned, contact::SampleRule samples, double error) {
  TwoBalls balls;
  backend() = which;
  balls.samples = samples;
  ContactSpec law;
  law.stiffness_pa_m = 1e6;
  law.damping_pa_s_m = 1e4;
  law.friction = 0.3;
  contact::ContactForce term;
  contact::ImageOptions options = balls.options();
  options.quadrature_error = error;
  term.add_pair(balls.source(pruned, options), law);
  term.refresh(balls.state.view());
  Felt out{VecX::Zero(balls.state.view().u.size()), term.samples().size()};
  term.add_force(balls.state.view(), out.force);
  return out;
}

}  // namespace

ON_EACH_BACKEND(SameForces);

// The image says which triangles face each other, their gap is computed in double: where the images agree on
// that, so do the forces, to the rounding of sums in another order.
TEST_P(SameForces, AsLinesInDoubleGive) {
  for (const bool pruned : {false, true})
    for (const auto samples : {contact::SampleRule::kPixel, contact::SampleRule::kVertex})
      for (const double error : {0.0, 1e-3}) {
        SCOPED_TRACE(testing::Message()
                     << "pruned " << pruned << ", rule " << static_cast<int>(samples) << ", error " << error);
        const Felt exact = felt_by(contact::DepthBackend::kExact, pruned, samples, error),
                   here = felt_by(GetParam(), pruned, samples, error);
        EXPECT_GT(exact.samples, samples == contact::SampleRule::kPixel && error == 0.0 ? 500u : 40u);
        EXPECT_EQ(here.samples, exact.samples);
        EXPECT_GT(exact.force.norm(), 100.0);
        EXPECT_LT((here.force - exact.force).norm(), 1e-12 * exact.force.norm());
      }
}

// Nor on the instructions that it has: where they round a pixel to a neighbour, exact lines correct it.
TEST(SameForcesOfTheProcessor, WhateverItsInstructions) {
  for (const bool pruned : {false, true})
    for (const double error : {0.0, 1e-3}) {
      std::vector<Felt> felt;
      for (const char* set : {"baseline", "avx2", "avx512"}) {
        setenv("PALPATE_INSTRUCTIONS", set, 1);
        try {
          felt.push_back(felt_by(contact::DepthBackend::kCpu, pruned, contact::SampleRule::kPixel, error));
        } catch (const Error&) {}  // this processor does not have it
        unsetenv("PALPATE_INSTRUCTIONS");
      }
      ASSERT_FALSE(felt.empty());
      for (const Felt& one : felt) {
        EXPECT_GT(one.force.norm(), 100.0);
        EXPECT_EQ(one.samples, felt[0].samples);
        EXPECT_LT((one.force - felt[0].force).norm(), 1e-12 * felt[0].force.norm());
      }
    }
}
