#include "integrate/error_weights.h"

#include <gtest/gtest.h>

#include "palpate/dynamics/rigid_body.h"
#include "palpate/dynamics/state.h"

namespace palpate {
namespace {

using namespace dynamics;

/// Two nodes of scale (0.1 m, 2 m/s) and a rigid body of scale (0.5 m, 3 m/s).
struct TwoBlocks {
  State state;
  TwoBlocks() {
    BlockSpec nodes{.name = "n", .q_size = 6, .u_size = 6, .q_scale = 0.1, .u_scale = 2.0};
    state.insert(nodes, VecX::Zero(6), VecX::Constant(6, 4.0));
    state.insert(rigid_block("b", 0.5, 3.0), VecX::Unit(7, 0), VecX::Zero(6));
  }
};

constexpr int kSize = 25;
const IntegratorSpec kSpec{.rtol = 1e-4, .atol_q = 0.01, .atol_u = 0.1};

VecX weights(const TwoBlocks& two, const std::vector<char>& driven) {
  VecX w(kSize);
  integrate::error_weights(two.state.layout(), kSpec, driven, two.state.u().data(), w.data());
  return w;
}

TEST(ErrorWeights, AreTheInversesOfTheTolerances) {
  const VecX w = weights(TwoBlocks{}, std::vector<char>(12, 0));
  EXPECT_DOUBLE_EQ(w[0], 1.0 / (1e-4 * 0.01 * 0.1));          // node position
  EXPECT_DOUBLE_EQ(w[6], 1.0 / (1e-4 * 0.01));                // quaternion
  EXPECT_DOUBLE_EQ(w[10], 1.0 / (1e-4 * 0.01 * 0.5));         // body position
  EXPECT_DOUBLE_EQ(w[13], 1.0 / (1e-4 * (0.1 * 2.0 + 4.0)));  // node velocity, rms 4
  EXPECT_DOUBLE_EQ(w[19], 1.0 / (1e-4 * 0.1 * 3.0 / 0.5));    // angular velocity at rest
  EXPECT_DOUBLE_EQ(w[22], 1.0 / (1e-4 * 0.1 * 3.0));
}

TEST(ErrorWeights, DrivenDirectionsNeitherCountNorDilute) {
  std::vector<char> driven(12, 0);
  for (int dof : {0, 1, 2, 4}) driven[static_cast<std::size_t>(dof)] = 1;
  const VecX free = weights(TwoBlocks{}, std::vector<char>(12, 0)), w = weights(TwoBlocks{}, driven);
  VecX error = VecX::Zero(kSize);  // one tolerance in every free entry
  for (int i = 0; i < kSize; ++i)
    if (w[i] > 1.0) error[i] = 1.0 / free[i];
  EXPECT_EQ((error.array() > 0.0).count(), kSize - 8);
  EXPECT_NEAR(w.cwiseProduct(error).norm() / std::sqrt(kSize), 1.0, 1e-14);
  error[0] = error[13] = 1e3;  // driven entries are ignored
  EXPECT_NEAR(w.cwiseProduct(error).norm() / std::sqrt(kSize), 1.0, 1e-14);
}

}  // namespace
}  // namespace palpate
