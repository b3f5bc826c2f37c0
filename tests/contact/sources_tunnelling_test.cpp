// Vertices that tunnel through exact shapes between two queries: which are counted, and when the next query
// is due.
#include "surfaces.h"

using namespace contact_tests;

namespace {

/// Number of tunnelled vertices counted when the three vertices of a small triangle move from one place to
/// another between two queries.
long counted(contact::SampleSource& source, SurfaceWorld& world, const Vec3& from, const Vec3& to) {
  const auto at = [&](const Vec3& x) {
    std::vector<contact::ContactSample> samples;
    for (int i = 0; i < 3; ++i) world.state.q().segment<3>(6 + 3 * i) = x + 1e-4 * Vec3::Unit(i);
    source.query(world.state.view(), samples);
  };
  at(from);
  const long before = source.report().tunnelled;
  at(to);
  return source.report().tunnelled - before;
}

}  // namespace

TEST(Tunnelling, WhatGoesThroughUnseenIsCountedAndNothingElse) {
  TriMesh one;
  one.vertices = Points::Zero(3, 3);
  one.faces.resize(3, 1);
  one.faces << 0, 1, 2;
  const auto frame = contact::fixed_frame();
  struct Shape {
    std::unique_ptr<contact::SampleSource> source;
    Vec3 above, inside, below, beside;
    Vec3 rim, past_rim;                        ///< both outside, with a corner of the shape between them
    Vec3 corner = above, past_corner = below;  ///< both outside, with a large part of the shape between them
  };
  SurfaceWorld world(one);
  std::vector<Shape> shapes;
  shapes.push_back({contact::make_box_source(world.surface, 0, frame, {}, Vec3(2, 2, 0.02), 0.01),
                    {0.1, 0.2, 0.5},
                    {0.1, 0.2, 0},
                    {0.3, 0.1, -0.4},
                    {3, 0, -0.5},
                    {0.995, 0, 0.0105},
                    {1.0005, 0, 0.0095},
                    {0.9, 0, 0.012},
                    {1.1, 0, -0.004}});
  shapes.push_back({contact::make_sphere_source(world.surface, 0, frame, Vec3::Zero(), 0.1, 0.01),
                    {0.02, 0, 0.5},
                    {0, 0.02, 0},
                    {0, 0.03, -0.4},
                    {1.5, 0, -0.5},
                    {0.095, 0, 0.035},
                    {0.095, 0, -0.035}});
  shapes.push_back(
      {contact::make_cylinder_source(world.surface, 0, frame,
                                     {quaternion_of(Vec3(kPi / 2, 0, 0)), Vec3::Zero()}, 0.05, 2.0, 0.01),
       {0.01, 0.2, 0.5},
       {0, 0.2, 0.01},
       {-0.01, 0.3, -0.4},
       {1.5, 0, -0.5},
       {0.0475, 0.2, 0.0175},
       {0.0475, 0.2, -0.0175}});
  for (Shape& s : shapes) {
    const std::string& name = s.source->traits().name;
    EXPECT_EQ(counted(*s.source, world, s.above, s.below), 3) << name;
    EXPECT_EQ(counted(*s.source, world, s.below, s.above), 3) << name << ", back again";
    EXPECT_EQ(counted(*s.source, world, s.above, s.inside), 0) << name << ": seen, it is inside";
    EXPECT_EQ(counted(*s.source, world, s.inside, s.below), 0) << name << ": it was seen inside";
    EXPECT_EQ(counted(*s.source, world, s.above, s.beside), 0) << name << ": it passes by";
    EXPECT_EQ(counted(*s.source, world, s.rim, s.past_rim), 0) << name << ": it grazes a rim";
    EXPECT_EQ(counted(*s.source, world, s.corner, s.past_corner), 3) << name << ", by a corner";
    EXPECT_EQ(counted(*s.source, world, s.above, s.above), 0) << name << ": it stands still";
  }
  auto plane = contact::make_plane_source(world.surface, 0, frame, Vec3::Zero(), Vec3::UnitZ(), 0.01);
  EXPECT_EQ(counted(*plane, world, {0, 0, 1}, {0, 0, -1}), 0) << "behind a plane is inside";
}

// The obstacle may be the moving body.
TEST(Tunnelling, IsSeenFromTheFrameThatMoves) {
  TriMesh one;
  one.vertices = Points::Zero(3, 3);
  one.faces.resize(3, 1);
  one.faces << 0, 1, 2;
  SurfaceWorld world(one);
  auto frame = std::make_shared<contact::TrajectoryFrame>();
  frame->append(0.0, {Quat::Identity(), Vec3(0, 0, -1)}, {Vec3::Zero(), Vec3(0, 0, 2)});
  auto source = contact::make_box_source(world.surface, 0, frame, {}, Vec3(1, 1, 0.01), 0.01);
  std::vector<contact::ContactSample> samples;
  source->query(world.state.view(), samples);
  world.state.set_time(1.0);
  source->query(world.state.view(), samples);
  EXPECT_EQ(source->report().tunnelled, 3);
}

// Three vertices of a block fly at a plate: the next query is due when they have penetrated half of its
// thickness.
TEST(Tunnelling, SaysWhenTheNextQueryIsDue) {
  TriMesh one;
  one.vertices = Points::Zero(3, 3);
  one.faces.resize(3, 1);
  one.faces << 0, 1, 2;
  SurfaceWorld world(one);
  for (int i = 0; i < 3; ++i) {
    world.state.q().segment<3>(6 + 3 * i) = Vec3(0, 0, 0.51) + 1e-4 * Vec3(i == 1, i == 2, 0);
    world.state.u().segment<3>(6 + 3 * i) = Vec3(0, 0, -50.0);
  }
  const auto asked = [&](contact::SampleSource& source) {
    std::vector<contact::ContactSample> samples;
    source.query(world.state.view(), samples);
    return source.report().safe_time;
  };
  const auto frame = contact::fixed_frame();
  const auto box = contact::make_box_source(world.surface, 0, frame, {}, Vec3(2, 2, 0.02), 0.01, 0.01);
  EXPECT_NEAR(asked(*box), (0.5 + 0.01) / 50.0, 1e-12);
  EXPECT_EQ(box->report().fast_regions, 0) << "the next query comes before they are through";
  const auto late = contact::make_box_source(world.surface, 0, frame, {}, Vec3(2, 2, 0.02), 0.01, 0.02);
  asked(*late);
  EXPECT_EQ(late->report().fast_regions, 1);
  const auto sphere = contact::make_sphere_source(world.surface, 0, frame, Vec3::Zero(), 0.01, 0.01, 0.01);
  EXPECT_NEAR(asked(*sphere), (0.5 + 0.01) / 50.0, 1e-6);
  const auto plane = contact::make_plane_source(world.surface, 0, frame, Vec3::Zero(), Vec3::UnitZ(), 0.01);
  EXPECT_EQ(asked(*plane), HUGE_VAL) << "behind a plane is inside";
  world.state.u().setZero();
  EXPECT_EQ(asked(*box), HUGE_VAL);
}
