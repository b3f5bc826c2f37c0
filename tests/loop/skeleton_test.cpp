// Bones of a model file in scenes: welded, scripted, and on joints.
#include <gtest/gtest.h>

#include <filesystem>

#include "bones/path.h"
#include "bones/shape.h"
#include "core/counters.h"
#include "loop/scene_checks.h"
#include "palpate/core/error.h"
#include "palpate/dynamics/rigid_body.h"
#include "palpate/loop/recorder.h"
#include "palpate/loop/run.h"
#include "palpate/loop/world.h"
#include "palpate/mesh/generators.h"
#include "store/bone_file.h"
#include "store/model_file.h"
#include "temporary_folder.h"

using namespace palpate;
using namespace palpate::scene_checks;

namespace {

/// A limb along x, 24 cm long, around a chain of three bones of 6 cm; nodes on its axis within a bone are
/// carried by the bone.
LayeredModel limb_model() {
  LayeredModel model;
  model.name = "limb";
  model.tets = mesh::box(Vec3(0.24, 0.04, 0.04), {24, 4, 4});
  const char* names[] = {"upper", "lower", "hand"};
  for (int i = 0; i < 3; ++i) {
    palpate::Bone bone;
    bone.name = names[i];
    bone.parent = i - 1;
    bone.head = Vec3(-0.11 + 0.075 * i, 0.0, 0.0);
    bone.tail = bone.head + Vec3(0.06, 0.0, 0.0);
    bone.head_radius = 0.008;
    bone.tail_radius = 0.006;
    model.skeleton.bones.push_back(bone);
  }
  for (Eigen::Index n = 0; n < model.tets.nodes.cols(); ++n) {
    const Vec3 x = model.tets.nodes.col(n);
    int owner = -1;
    for (int i = 0; i < 3; ++i)
      if (x.tail<2>().norm() < 1e-9 &&
          x.x() > model.skeleton.bones[static_cast<std::size_t>(i)].head.x() - 1e-9 &&
          x.x() < model.skeleton.bones[static_cast<std::size_t>(i)].tail.x() + 1e-9)
        owner = i;
    model.bone_of_node.push_back(owner);
  }
  return model;
}

/// The model file, which exists for the duration of the test.
struct ModelOnDisk {
  TemporaryFolder folder;
  std::string path = (folder / "limb.h5").string();
  ModelOnDisk() { store::write_model(path, {limb_model(), {}}); }
};

scene::Description limb(const ModelOnDisk& file) {
  scene::Description d;
  d.name = "limb";
  d.duration_s = 0.1;
  SoftBodySpec body;
  body.name = "limb";
  body.mesh.file = file.path;
  body.position_m = Vec3(0.1, 0.2, 0.3);
  body.rotation_vector_rad = Vec3(0.2, -0.1, 0.4);
  body.youngs_modulus_pa = 2e4;
  body.stiffness_damping_s = 2e-3;
  body.skeleton.emplace();
  d.bodies.push_back(body);
  d.integrator.name = "linearly-implicit-euler";
  d.integrator.step_s = 0.002;
  return d;
}

JointSpec joint_of(const std::string& bone, std::optional<JointType> type = {}) {
  JointSpec joint;
  joint.bone = bone;
  joint.type = type;
  return joint;
}

JointSpec scripted(const std::string& bone, const Vec3& rotation, const Vec3& shift = Vec3::Zero()) {
  JointSpec joint = joint_of(bone);
  joint.keyframes.resize(2);
  joint.keyframes[1].time_s = 0.1;
  joint.keyframes[1].rotation_vector_rad = rotation;
  joint.keyframes[1].position_m = shift;
  return joint;
}

}  // namespace

TEST(Skeleton, OnlyASceneThatNamesItHasOne) {
  const ModelOnDisk file;
  scene::Description d = limb(file);
  d.bodies[0].skeleton.reset();
  counters::reset();
  const auto without = loop::assemble(d);
  EXPECT_TRUE(without->bones.empty() && without->bodies[0].skeleton.bones.empty());
  EXPECT_EQ(counters::snapshot()["loop.skeleton"], 0);
  EXPECT_EQ(counters::snapshot()["tool.simbody_system"], 0);
  const auto with = loop::assemble(limb(file));
  EXPECT_EQ(counters::snapshot()["loop.skeleton"], 1);
  EXPECT_EQ(counters::snapshot()["tool.simbody_system"], 0) << "welded bones need no Simbody";
}

TEST(Skeleton, WeldedBonesHoldTheirNodes) {
  const ModelOnDisk file;
  scene::Description d = limb(file);
  d.gravity_m_s2 = Vec3(0, 0, -9.81);
  const auto world = loop::assemble(d);
  ASSERT_EQ(world->bones.size(), 3u);
  EXPECT_EQ(world->bones[0].name, "limb upper");
  EXPECT_EQ(world->state.layout().border_size(), 0);
  EXPECT_EQ(world->bones[1].dofs.size(), 3u * 6u)
      << "nodes 1 cm apart on 6 cm, from half a step behind the head";
  const Points before = world->positions(world->bodies[0]);
  ASSERT_TRUE(loop::run(*world, {}).status.ok());
  const Points after = world->positions(world->bodies[0]);
  const std::vector<int> owner = limb_model().bone_of_node;
  double tissue = 0.0;
  for (Eigen::Index n = 0; n < after.cols(); ++n) {
    const double moved = (after.col(n) - before.col(n)).norm();
    if (owner[static_cast<std::size_t>(world->bodies[0].file_node[static_cast<std::size_t>(n)])] >= 0)
      EXPECT_LT(moved, 1e-15);
    else
      tissue = std::max(tissue, moved);
  }
  EXPECT_GT(tissue, 1e-4) << "and the tissue sags on them";
}

// Path, twist and acceleration of a chain of scripts are derivatives of one another; the joint stays
// connected; rotations are in the body's axes.
TEST(Skeleton, AChainOfScriptsMovesAsItsDerivativesSay) {
  bones::PrescribedJoint first{{quaternion_of(Vec3(0.1, 0.2, -0.3)), Vec3(0.3, 0.1, 0.2)},
                               Vec3(0.25, 0.1, 0.2),
                               quaternion_of(Vec3(0.4, 0.0, 0.2)),
                               {}};
  first.keyframes = scripted("a", Vec3(0.9, -0.5, 0.3), Vec3(0.02, 0.01, -0.03)).keyframes;
  bones::PrescribedJoint second{
      {quaternion_of(Vec3(-0.3, 0.1, 0.2)), Vec3(0.5, 0.2, 0.1)}, Vec3(0.4, 0.15, 0.15), first.axes, {}};
  second.keyframes = scripted("b", Vec3(-0.4, 0.8, 0.6)).keyframes;
  const dynamics::Path upper = bones::prescribed_path(first, {}, {}),
                       lower = bones::prescribed_path(second, upper, first.start);
  EXPECT_LT(pose_difference(lower(0.0).pose, second.start).norm(), 1e-15);
  constexpr double e = 1e-5;
  for (const dynamics::Path& path : {upper, lower})
    for (const double t : {0.02, 0.05, 0.081}) {
      const dynamics::PathPoint at = path(t), before = path(t - e), after = path(t + e);
      const Vec6 rate = pose_difference(before.pose, after.pose) / (2.0 * e);
      EXPECT_LT((rate.head<3>() - at.twist.angular).norm() + (rate.tail<3>() - at.twist.linear).norm(), 3e-5);
      EXPECT_LT(((after.twist.angular - before.twist.angular) / (2.0 * e) - at.acceleration.angular).norm(),
                3e-3);
      EXPECT_LT(((after.twist.linear - before.twist.linear) / (2.0 * e) - at.acceleration.linear).norm(),
                3e-3);
      EXPECT_GT(at.acceleration.linear.norm(), 1.0);
    }
  const dynamics::PathPoint u = upper(0.05), l = lower(0.05);
  EXPECT_LT(((u.pose * (first.start.inverse() * second.position)) -
             (l.pose * (second.start.inverse() * second.position)))
                .norm(),
            1e-15)
      << "no shift: the joint holds";
  const Quat rotation = first.axes * quaternion_of(Vec3(0.9, -0.5, 0.3)) * first.axes.conjugate();
  EXPECT_LT(rotation_vector(upper(0.1).pose.rotation * (rotation * first.start.rotation).conjugate()).norm(),
            1e-14);
}

TEST(Skeleton, AScriptTakesTheTissueAlong) {
  const ModelOnDisk file;
  scene::Description d = limb(file);
  d.bodies[0].skeleton->joints.push_back(scripted("lower", Vec3(0, 0, 0.5)));
  const auto world = loop::assemble(d);
  EXPECT_EQ(world->state.layout().border_size(), 0) << "prescribed, all of it";
  const Vec3 before = world->bone_pose(world->bones[2]).translation;
  ASSERT_TRUE(loop::run(*world, {}).status.ok());
  const Vec3 after = world->bone_pose(world->bones[2]).translation;
  const Vec3 joint =
      quaternion_of(d.bodies[0].rotation_vector_rad) * Vec3(-0.035, 0, 0) + d.bodies[0].position_m;
  EXPECT_NEAR((after - joint).norm(), (before - joint).norm(), 1e-14);
  EXPECT_NEAR((after - before).norm(), 2.0 * std::sin(0.25) * (before - joint).norm(), 1e-12)
      << "the hand goes with what it hangs on";
}

#ifdef PALPATE_HAS_TOOL
namespace {

scene::Description jointed(const ModelOnDisk& file, JointType root = JointType::kWeld) {
  scene::Description d = limb(file);
  d.bodies[0].skeleton->root = root;
  d.bodies[0].skeleton->others = JointType::kBall;
  d.bodies[0].skeleton->density_kg_m3 = 800.0;
  return d;
}

}  // namespace

TEST(Skeleton, BonesOnJointsAreOneBlockAndCarryTheirNodes) {
  const ModelOnDisk file;
  scene::Description d = jointed(file);
  d.bodies[0].skeleton->joints.push_back(joint_of("hand", JointType::kHinge));
  d.bodies[0].skeleton->joints[0].axis = Vec3::UnitY();
  counters::reset();
  const auto world = loop::assemble(d);
  EXPECT_EQ(world->state.layout().border_size(), 3 + 1) << "a ball and a hinge; the root is welded";
  EXPECT_EQ(counters::snapshot()["tool.simbody_system"], 1);
  d.bodies[0].skeleton->root = JointType::kFree;
  EXPECT_EQ(loop::assemble(d)->state.layout().border_size(), 6 + 3 + 1);
}

// Under its weight, held by the upper bone: nodes follow their bones, joints hold, and the hand hangs lower
// than the bone that carries it.
TEST(Skeleton, ALimbOnJointsHangsFromItsRoot) {
  const ModelOnDisk file;
  for (const char* name : {"linearly-implicit-euler", "implicit-midpoint", "cvode-bdf"}) {
    scene::Description d = jointed(file);
    d.gravity_m_s2 = Vec3(0, 0, -9.81);
    d.duration_s = 0.2;
    d.integrator.name = name;
    d.bodies[0].youngs_modulus_pa = 3e3;
    const auto world = loop::assemble(d);
    const Points before = world->positions(world->bodies[0]);
    std::vector<Pose> start;
    for (const loop::Bone& bone : world->bones) start.push_back(world->bone_pose(bone));
    ASSERT_TRUE(loop::run(*world, {}).status.ok()) << name;
    const Points after = world->positions(world->bodies[0]);
    for (std::size_t b = 0; b < start.size(); ++b)
      for (const int dof : world->bones[b].dofs) {
        const Vec3 then = start[b].inverse() * Vec3(before.col(dof / 3)),
                   now = world->bone_pose(world->bones[b]).inverse() * Vec3(after.col(dof / 3));
        EXPECT_LT((now - then).norm(), 1e-12) << name << ", bone " << b;
      }
    const double fall =
        world->bone_pose(world->bones[2]).translation.z() -
        (d.bodies[0].position_m + quaternion_of(d.bodies[0].rotation_vector_rad) * Vec3(0.07, 0, 0)).z();
    EXPECT_LT(fall, -5e-3) << name;
  }
}

// A free limb without external forces conserves its momentum.
TEST(Skeleton, AFreeLimbKeepsItsMomentum) {
  const ModelOnDisk file;
  for (const auto& [name, step, bar] :
       {std::tuple{"implicit-midpoint", 0.002, 1e-4}, {"cvode-bdf", 0.002, 1e-4}}) {
    scene::Description d = jointed(file, JointType::kFree);
    d.bodies[0].youngs_modulus_pa = 500.0;
    d.bodies[0].velocity_m_s = Vec3(0.3, -0.2, 0.1);
    d.bodies[0].angular_velocity_rad_s = Vec3(2.0, 8.0, -3.0);
    d.integrator.name = name;
    d.integrator.step_s = step;
    d.integrator.rtol = 1e-6;
    const auto world = loop::assemble(d);
    VecX inertia(9);
    for (int b = 0; b < 3; ++b) {
      const bones::TaperedBone shape =
          bones::tapered_bone(world->bodies[0].skeleton.bones[static_cast<std::size_t>(b)]);
      inertia.segment<3>(3 * b) = 800.0 * shape.volume * shape.unit_moments;
    }
    const Vec6 before = momentum(*world, inertia);
    ASSERT_TRUE(loop::run(*world, {}).status.ok()) << name;
    const Vec6 change = momentum(*world, inertia) - before;
    EXPECT_LT(change.head<3>().norm(), bar * before.head<3>().norm()) << name;
    EXPECT_LT(change.tail<3>().norm(), bar * before.tail<3>().norm()) << name;
    const Quat rotation =
        world->bone_pose(world->bones[2]).rotation * world->bone_pose(world->bones[0]).rotation.conjugate();
    EXPECT_GT(rotation_vector(rotation).norm(), 5e-3) << "it bends while it tumbles: the joints take part";
  }
}

// A tool presses on the hand from above: the joints yield, the tissue between tool and bone is dented, and
// the springs return the hand after the tool has left. With welded joints no bone moves.
TEST(Skeleton, AToolMovesPassiveJointsAndDentsTheFlesh) {
  const ModelOnDisk file;
  const auto pressed = [&](JointType joints, const std::string& linearisation, double duration_s) {
    scene::Description d = jointed(file);
    d.bodies[0].position_m.setZero();
    d.bodies[0].rotation_vector_rad.setZero();
    d.bodies[0].skeleton->others = joints;
    d.bodies[0].skeleton->stiffness_n_m_rad = 1.0;
    d.bodies[0].skeleton->damping_n_m_s_rad = 0.05;
    d.tool.emplace();
    d.tool->radius_m = 0.02;
    d.tool->position_m = Vec3(0.075, 0.0, 0.041);  // 1 mm above the skin
    d.device.emplace();
    for (const auto& [time, lower] : {std::pair{0.0, 0.0}, {0.2, 0.025}, {0.3, 0.025}, {0.5, 0.0}})
      d.device->keyframes.push_back(
          {time, d.tool->position_m - Vec3(0, 0, lower), Vec3::Zero(), Interpolation::kMinimumJerk});
    ContactSpec contact;
    contact.first = "limb";
    contact.second = "tool";
    contact.stiffness_pa_m = 1e7;
    d.contacts.push_back(contact);
    d.exchange.linearisation = linearisation;
    d.exchange.exchange_period_s = d.exchange.contact_refresh_s = d.integrator.step_s = 0.01;
    d.duration_s = duration_s;
    auto world = loop::assemble(d);
    const loop::RunResult result = loop::run(*world, {});
    EXPECT_TRUE(result.status.ok()) << result.status.message;
    EXPECT_TRUE(world->state.q().allFinite());
    return world;
  };
  const auto turned = [](const loop::World& world) {  // hand about y, positive downwards [rad]
    const Pose start = bones::tapered_bone(limb_model().skeleton.bones[2]).frame;
    return rotation_vector(world.bone_pose(world.bones[2]).rotation * start.rotation.conjugate()).y();
  };
  const auto dent = [](const loop::World& world) {  // dent of the skin towards the bone, under the tool [m]
    const loop::Body& body = world.bodies[0];
    const Points now = world.positions(body);
    Eigen::Index top = 0;
    (body.placed.colwise() - Vec3(0.07, 0.0, 0.02)).colwise().norm().minCoeff(&top);
    const Vec3 before =
        bones::tapered_bone(limb_model().skeleton.bones[2]).frame.inverse() * Vec3(body.placed.col(top));
    return before.norm() - (world.bone_pose(world.bones[2]).inverse() * Vec3(now.col(top))).norm();
  };
  for (const char* linearisation : {"frozen", "condensed"}) {
    const auto held = pressed(JointType::kBall, linearisation, 0.3);
    EXPECT_GT(turned(*held), 0.07) << linearisation << ": 4 degrees";
    EXPECT_LT(turned(*held), 0.025 / 0.075) << linearisation << ": no farther than the handle goes";
    EXPECT_GT(dent(*held), 1e-3) << linearisation;
    const auto left = pressed(JointType::kBall, linearisation, 1.2);
    EXPECT_LT(std::abs(turned(*left)), 0.02) << linearisation;
    const auto welded = pressed(JointType::kWeld, linearisation, 0.3);
    EXPECT_EQ(turned(*welded), 0.0) << linearisation;
    EXPECT_GT(dent(*welded), dent(*held)) << linearisation << ": the flesh alone gives way";
  }
}

TEST(Skeleton, IsRecordedBoneByBone) {
  const ModelOnDisk file;
  scene::Description d = jointed(file);
  d.gravity_m_s2 = Vec3(0, 0, -9.81);
  d.duration_s = 0.02;
  d.record.emplace();
  d.record->state_period_s = 0.01;
  const auto world = loop::assemble(d);
  const std::string folder = (file.folder / "out").string();
  {
    loop::Recorder recorder(*world, folder);
    loop::RunOptions options;
    options.observers.push_back(&recorder);
    ASSERT_TRUE(loop::run(*world, options).status.ok());
  }
  const std::vector<store::BoneRow> rows = store::read_bones(folder + "/bones.csv");
  EXPECT_EQ(rows.size() % 3, 0u);
  ASSERT_GE(rows.size(), 6u);
  EXPECT_GT(rows.back().twist.angular.norm(), 0.0);
}

TEST(Skeleton, RefusesWhatCannotHang) {
  const ModelOnDisk file;
  scene::Description d = jointed(file);
  d.bodies[0].skeleton->density_kg_m3 = 0.0;
  EXPECT_NE(refusal(d).find("density_kg_m3 is missing: \"lower\" moves freely"), std::string::npos)
      << refusal(d);
  d = jointed(file);
  d.bodies[0].skeleton->joints.push_back(joint_of("hnad", JointType::kWeld));
  EXPECT_NE(refusal(d).find("has no bone \"hnad\" (did you mean \"hand\"?)"), std::string::npos)
      << refusal(d);
  d = jointed(file);
  d.bodies[0].skeleton->joints.push_back(scripted("hand", Vec3(0, 0, 1)));
  EXPECT_NE(refusal(d).find("has keyframes, but its parent \"lower\" moves freely"), std::string::npos)
      << refusal(d);
  d = jointed(file);
  d.bodies[0].skeleton->joints.push_back(scripted("upper", Vec3(0, 0, 1)));
  EXPECT_NE(refusal(d).find("cannot have the parent \"upper\", which moves by keyframes"), std::string::npos)
      << refusal(d);
  d = jointed(file);
  d.bodies[0].skeleton->joints.push_back(joint_of("hand", JointType::kFree));
  EXPECT_NE(refusal(d).find("type = \"free\" is for a bone without a parent"), std::string::npos)
      << refusal(d);
}

#endif
