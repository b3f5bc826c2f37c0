// Bones in scenes: assembly, conserved quantities, recording.
#include <gtest/gtest.h>

#include <filesystem>

#include "core/counters.h"
#include "loop/scene_checks.h"
#include "loop/small_scenes.h"
#include "loop/tool_instance.h"
#include "palpate/core/error.h"
#include "palpate/loop/recorder.h"
#include "palpate/loop/run.h"
#include "palpate/store/run_file.h"
#include "store/bone_file.h"
#include "temporary_folder.h"

using namespace palpate;
using namespace palpate::small_scenes;
using namespace palpate::scene_checks;

namespace {

/// A free block of tissue, 4 x 4 x 8 cm and 0.128 kg, around a capsule of a thousandth of its mass.
scene::Description limb() {
  scene::Description d;
  d.name = "limb";
  d.duration_s = 0.1;
  SoftBodySpec body;
  body.name = "tissue";
  body.mesh.generator = "box";
  body.mesh.size_m = Vec3(0.04, 0.04, 0.08);
  body.mesh.element_size_m = 0.01;
  body.youngs_modulus_pa = 2e4;
  body.stiffness_damping_s = 2e-3;
  AttachmentSpec tie;
  tie.region = Selection::kShape;
  tie.to = "bone";
  body.attachments.push_back(tie);
  d.bodies.push_back(body);
  BoneSpec bone;
  bone.name = "bone";
  bone.shape = BoneShape::kCapsule;
  bone.radius_m = 0.0105;
  bone.length_m = 0.04;
  bone.mass_kg = 1.28e-4;
  bone.angular_velocity_rad_s = Vec3(0.0, 10.0, 0.0);
  d.bones.push_back(bone);
  d.bodies[0].angular_velocity_rad_s = bone.angular_velocity_rad_s;
  d.integrator.name = "linearly-implicit-euler";
  d.integrator.step_s = 0.01;
  return d;
}

}  // namespace

TEST(Bones, AFreeOneIsABlockAndCarriesTheNodesInside) {
  const auto world = loop::assemble(limb());
  ASSERT_EQ(world->bones.size(), 1u);
  EXPECT_EQ(world->state.layout().border_size(), 6);
  EXPECT_EQ(world->bones[0].dofs.size(), 3u * 27u)
      << "nodes 1 cm apart: five in each of the five layers of the rod, one in each cap";
  for (int dof : world->bones[0].dofs)
    EXPECT_TRUE(world->system.driven_mask()[static_cast<std::size_t>(dof)]);
}

TEST(Bones, ASceneWithoutOneHasNoRigidBlock) {
  const long simbody = counters::snapshot()["tool.simbody_system"];
  const auto world = loop::assemble(held_block());
  EXPECT_TRUE(world->bones.empty());
  EXPECT_EQ(world->state.layout().border_size(), 0);
  const auto with = loop::assemble(limb());
  EXPECT_EQ(counters::snapshot()["tool.simbody_system"], simbody) << "and one with a bone needs no Simbody";
}

TEST(Bones, TissueAndBoneTumbleFreelyWithoutLoss) {
  for (const char* name : {"linearly-implicit-euler", "backward-euler", "implicit-midpoint", "cvode-bdf"}) {
    scene::Description d = limb();
    d.integrator.name = name;
    d.integrator.rtol = 1e-5;
    d.integrator.step_s = 0.001;
    const auto world = loop::assemble(d);
    const Vec6 before = momentum(*world);
    ASSERT_TRUE(loop::run(*world, {}).status.ok()) << name;
    const Vec6 change = momentum(*world) - before;
    const bool first_order =
        std::string(name) == "linearly-implicit-euler" || std::string(name) == "backward-euler";
    EXPECT_LT(change.head<3>().norm(), (first_order ? 0.05 : 1e-3) * before.head<3>().norm()) << name;
    EXPECT_LT(change.tail<3>().norm(), 1e-3 * 0.128 * 0.4) << name;
  }
}

TEST(Bones, AFixedOneIsAFixedAttachment) {
  scene::Description d = limb();
  d.bodies[0].angular_velocity_rad_s.setZero();
  d.gravity_m_s2 = Vec3(0, 0, -9.81);
  d.bones[0].fixed = true;
  d.bones[0].shape = BoneShape::kBox;
  d.bones[0].size_m = Vec3(0.0202, 0.0202, 0.0602);
  const auto tied = loop::assemble(d);
  EXPECT_EQ(tied->state.layout().border_size(), 0);
  ASSERT_TRUE(loop::run(*tied, {}).status.ok());
  d.bones.clear();
  d.bodies[0].attachments[0].to.clear();
  d.bodies[0].attachments[0].region = Selection::kBox;
  d.bodies[0].attachments[0].box_min_m = Vec3(-0.0101, -0.0101, -0.0301);
  d.bodies[0].attachments[0].box_max_m = -d.bodies[0].attachments[0].box_min_m;
  const auto boxed = loop::assemble(d);
  ASSERT_EQ(boxed->system.driven_dofs(), tied->system.driven_dofs());
  ASSERT_TRUE(loop::run(*boxed, {}).status.ok());
  EXPECT_LT((tied->state.q() - boxed->state.q()).norm(), 1e-12);
  for (int dof : tied->bones[0].dofs)
    EXPECT_NEAR(tied->state.q()[dof], tied->bodies[0].placed(dof % 3, dof / 3), 1e-15);
}

TEST(Bones, KeyframesMoveOneFromWhereItIsPlaced) {
  scene::Description d = limb();
  d.bones[0].rotation_vector_rad = Vec3(0, 0.3, 0);
  d.bodies[0].rotation_vector_rad = Vec3(0, 0.3, 0);
  d.bones[0].keyframes.resize(2);
  d.bones[0].keyframes[1].time_s = 0.1;
  d.bones[0].keyframes[1].position_m = Vec3(0.01, 0, 0);
  d.bones[0].keyframes[1].rotation_vector_rad = Vec3(0.5, 0, 0);
  const auto world = loop::assemble(d);
  EXPECT_EQ(world->state.layout().border_size(), 0);
  ASSERT_TRUE(loop::run(*world, {}).status.ok());
  ASSERT_FALSE(world->bones[0].dofs.empty());
  for (int dof : world->bones[0].dofs) {
    const Vec3 x =
        quaternion_of(Vec3(0.5, 0, 0)) * Vec3(world->bodies[0].placed.col(dof / 3)) + Vec3(0.01, 0, 0);
    EXPECT_NEAR(world->state.q()[dof], x[dof % 3], 1e-15);
  }
}

// A hanging limb at rest: the tissue exerts its weight on the bone that holds it, and on a free bone only the
// bone's inertial force.
TEST(Bones, TheWrenchOnABoneBalances) {
  scene::Description d = limb();
  d.bodies[0].angular_velocity_rad_s.setZero();
  d.gravity_m_s2 = Vec3(0, 0, -9.81);
  d.bones[0].fixed = true;
  d.bodies[0].stiffness_damping_s = 0.05;
  d.integrator.name = "backward-euler";
  d.duration_s = 2.0;
  const auto held = loop::assemble(d);
  ASSERT_TRUE(loop::run(*held, {}).status.ok());
  const Wrench w = held->wrenches_on_bones()[0];
  EXPECT_NEAR(w.force.z(), -9.81 * held->bodies[0].masses.sum(), 1e-6);
  EXPECT_LT(w.force.head<2>().norm() + w.moment.norm(), 1e-6);

  const auto free = loop::assemble(limb());
  VecX a;
  free->system.acceleration(free->state.view(), a);
  const Vec3 change = free->bones[0].mass * a.tail<3>();
  EXPECT_LT((free->wrenches_on_bones()[0].force - change).norm(), 1e-9);
}

TEST(Bones, AreRecordedWithTheirPoses) {
  const TemporaryFolder own;
  const std::string folder = own.string();
  scene::Description d = limb();
  d.record.emplace();
  d.record->state_period_s = 0.05;
  const auto world = loop::assemble(d);
  {
    loop::Recorder recorder(*world, folder);
    loop::RunOptions options;
    options.observers = {&recorder};
    ASSERT_TRUE(loop::run(*world, options).status.ok());
  }
  const auto rows = store::read_bones(folder + "/bones.csv");
  ASSERT_EQ(rows.size(), 3u) << "0, 0.05 and 0.1 s";
  EXPECT_EQ(rows[2].time_s, 0.1);
  const Pose now = world->bone_pose(world->bones[0]);
  EXPECT_LT(pose_difference(now, rows[2].pose).norm(), 1e-12);
  EXPECT_LT((world->bone_twist(world->bones[0]).angular - rows[2].twist.angular).norm(), 1e-12);
  EXPECT_GT(rotation_vector(rows[2].pose.rotation).norm(), 0.5)
      << "10 rad/s for 0.1 s, less what a step of 10 ms loses";
  const store::RunReader run(folder + "/run.vtkhdf");
  ASSERT_EQ(run.parts().size(), 2u);
  EXPECT_EQ(run.parts()[1].name, "bone");
  const Points surface = run.points(run.steps() - 1);
  const auto first = run.first_point(1);
  for (Eigen::Index i = 0; i < world->bones[0].surface.vertices.cols(); ++i)
    ASSERT_LT((surface.col(first + i) - now * Vec3(world->bones[0].surface.vertices.col(i))).norm(), 1e-12);
}

TEST(Bones, NodesThatNoBoneHoldsAreRefused) {
  scene::Description d = limb();
  d.bones[0].position_m = Vec3(1, 0, 0);
  EXPECT_NE(refusal(d).find("body \"tissue\": attachment: no node lies inside \"bone\""), std::string::npos)
      << refusal(d);
  d = limb();
  d.bodies[0].attachments[0].to = "tool";
  d.bodies[0].attachments[0].region = Selection::kBox;
  EXPECT_NE(refusal(d).find("bone \"bone\" carries no nodes"), std::string::npos) << refusal(d);
  d.bones.clear();
  d.bodies[0].attachments[0].region = Selection::kSphere;
  d.bodies[0].attachments[0].radius_m = 0.02;
  EXPECT_NE(refusal(d).find("neither a bone nor a tool"), std::string::npos) << refusal(d);
}

#ifdef PALPATE_HAS_TOOL
// The tool of a monolithic scheme carries tissue like a bone: the only external force is the coupling's.
TEST(Bones, TheToolOfAMonolithicSceneCarriesNodes) {
  scene::Description d = pressed_block(0.0);
  d.contacts.clear();
  d.exchange.scheme = scene::ExchangeScheme::kMonolithic;
  d.bodies[0].attachments[0].to = "tool";
  d.bodies[0].attachments[0].box_min_m = Vec3(-1, -1, 0.019);
  d.bodies[0].attachments[0].box_max_m = Vec3(1, 1, 0.021);
  KeyframeSpec lifted = d.device->keyframes[0];
  lifted.time_s = 0.02;
  lifted.position_m.z() += 0.01;
  d.device->keyframes.push_back(lifted);
  d.integrator.name = "backward-euler";
  const auto world = loop::assemble(d);
  ASSERT_TRUE(world->monolithic());
  ASSERT_TRUE(loop::run(*world, {}).status.ok());
  const auto& tool = *world->state.layout().find(world->tools[0].monolithic()->block_id);
  EXPECT_GT(world->state.q()[tool.q_offset + 6], d.tool->position_m.z() + 1e-3) << "it was lifted";
  VecX f, a;
  world->system.force(world->state.view(), f);
  world->system.acceleration(world->state.view(), a);
  Vec3 change = d.tool->mass_kg * a.segment<3>(tool.u_offset + 3);
  for (int i = 0; i < world->bodies[0].masses.size(); ++i)
    change += world->bodies[0].masses[i] * a.segment<3>(3 * i);
  EXPECT_LT((change - f.segment<3>(tool.u_offset + 3)).norm(), 1e-12 * f.lpNorm<1>())
      << "Newton's law for tool and tissue together";
  EXPECT_GT(f.segment<3>(tool.u_offset + 3).norm(), 1e-3);
}

// Partitioned scheme: the step matrix that is condensed onto the tool contains the bone's block as well as
// the tissue's.
TEST(Bones, AToolMayTouchTissueThatSitsOnAFreeBone) {
  scene::Description d = pressed_block(1e-3);
  d.bodies[0].attachments[0].to = "bone";
  BoneSpec bone;
  bone.name = "bone";
  bone.mass_kg = 1e-4;
  bone.inertia_kg_m2 = Vec3(1e-7, 1e-7, 1e-7);
  d.bones.push_back(bone);
  d.duration_s = 0.05;
  const auto world = loop::assemble(d);
  const loop::RunResult result = loop::run(*world, {});
  ASSERT_TRUE(result.status.ok()) << result.status.message;
  EXPECT_EQ(result.frozen_fallbacks, 0);
  EXPECT_LT(world->bone_twist(world->bones[0]).linear.z(), -1e-4)
      << "pushed away downwards, nothing holds it";
  EXPECT_TRUE(world->state.q().allFinite());
}
#endif
