#include "loop/linearise.h"

#include <gtest/gtest.h>

#include "loop/small_scenes.h"
#include "palpate/core/error.h"
#include "palpate/loop/run.h"
#ifdef PALPATE_HAS_TOOL
#include "palpate/tool/tool.h"

using namespace palpate;
using namespace palpate::small_scenes;

namespace {

constexpr double kDepth = 0.002;

std::unique_ptr<loop::World> touching(const std::string& linearisation) {
  scene::Description d = pressed_block(kDepth);
  d.coupling.linearisation = linearisation;
  auto world = loop::assemble(d);
  world->tool_frame->append(0.0, world->tool->pose(), {});
  world->contact->refresh(world->state.view());
  return world;
}

Mat6 stiffness(const dynamics::LinearisedContact& record) {
  return Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(record.J.data());
}

/// The wrench on the tool after one linearly implicit step of H with the tool displaced by `dx` at its end.
Vec6 wrench_after_step(double H, const Vec3& dx) {
  const auto world = touching("frozen");
  Pose moved = world->tool->pose();
  moved.translation += dx;
  world->tool_frame->clear();  // it stands there from now on
  world->tool_frame->append(0.0, moved, {});
  EXPECT_TRUE(world->stepper->advance_to(H).ok());
  const Wrench w = world->contact->frame_wrench(world->state.view(), world->tool_frame_index);
  Vec6 out;
  out << w.moment, w.force;
  return out;
}

// What `condensed` claims: the change of the wrench when the bodies have answered the tool's displacement by one linearly implicit step.
TEST(Linearise, CondensedIsTheAnswerOfOneImplicitStep) {
  const double H = 0.01, e = 1e-7;
  long fallbacks = 0;
  const auto world = touching("condensed");
  const dynamics::LinearisedContact record = loop::linearise_contact(*world, 1, H, fallbacks);
  EXPECT_EQ(record.source, dynamics::LinearisedContact::Source::kCondensed);
  EXPECT_EQ(fallbacks, 0);
  ASSERT_GT(record.samples, 0);
  const Mat6 J = stiffness(record);
  for (int axis = 0; axis < 3; ++axis) {
    const Vec6 change = (wrench_after_step(H, e * Vec3::Unit(axis)) - wrench_after_step(H, -e * Vec3::Unit(axis))) / (2 * e);
    const Vec3 expected = J.block<3, 1>(3, 3 + axis);
    const double size = J.bottomRightCorner(3, 3).norm();
    EXPECT_LT((change.tail(3) - expected).norm(), 1e-5 * size) << "axis " << axis;
  }
}

TEST(Linearise, BodiesThatAnswerAreSofterThanFrozenOnes) {
  long fallbacks = 0;
  const Mat6 frozen = stiffness(loop::linearise_contact(*touching("frozen"), 1, 0.01, fallbacks));
  const Mat6 condensed = stiffness(loop::linearise_contact(*touching("condensed"), 1, 0.01, fallbacks));
  EXPECT_LT(frozen(5, 5), condensed(5, 5)) << "a Schur complement takes stiffness away";
  EXPECT_LT(condensed(5, 5), 0.0);
}

TEST(Linearise, AShortPeriodLeavesTheBodiesNoTimeToAnswer) {
  long fallbacks = 0;
  const Mat6 frozen = stiffness(loop::linearise_contact(*touching("frozen"), 1, 1e-9, fallbacks));
  const Mat6 condensed = stiffness(loop::linearise_contact(*touching("condensed"), 1, 1e-9, fallbacks));
  EXPECT_LT((frozen - condensed).norm(), 1e-6 * frozen.norm());
}

TEST(Linearise, RecordRepeatsTheContactAtItsOwnPose) {
  long fallbacks = 0;
  const auto world = touching("condensed");
  const dynamics::LinearisedContact record = loop::linearise_contact(*world, 7, 0.01, fallbacks);
  EXPECT_EQ(record.version, 7u);
  const Vec6 w = dynamics::contact_wrench(record, world->tool->pose(), world->tool->twist());
  const Wrench exact = world->contact->frame_wrench(world->state.view(), world->tool_frame_index);
  EXPECT_LT((w.tail<3>() - exact.force).norm(), 1e-14 * exact.force.norm());
  EXPECT_GT(exact.force.z(), 0.0) << "the block pushes the tool up";
}

}  // namespace
#endif
