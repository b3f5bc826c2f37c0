// Tests how much the contact force jumps along smooth paths.
#include "product/continuity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>

#include "contact/block_model.h"
#include "palpate/loop/load.h"
#include "product/contact/relative_path.h"

using namespace palpate;
using block_model::block;
using block_model::ModelOnDisk;

namespace {

// Remainder of a step after seven bisections: 1 % for the change that they leave, and the share of a point.
constexpr double kBound = 0.02;
constexpr double kSeen = 0.1;  // Fraction of the scene's largest force: below it few points are in contact.

struct Blocks {
  std::deque<ModelOnDisk> files;

  SoftBodySpec body(const std::string& name, const LayeredModel& model) {
    SoftBodySpec out;
    out.name = name;
    out.mesh.file = files.emplace_back(model, name + ".h5").path;
    out.skin = out.proxies = true;
    return out;
  }
  static ContactSpec contact(const std::string& first, const std::string& second) {
    ContactSpec out;
    out.first = first;
    out.second = second;
    out.stiffness_pa_m = 1e6;
    return out;
  }
  /// Returns a slab, and a block with an edge towards it.
  scene::Description ridge() {
    scene::Description d;
    d.name = "ridge";
    d.bodies = {body("slab", block({Quat::Identity(), Vec3::Zero()}, Vec3(0.06, 0.06, 0.02), {4, 4, 2})),
                body("edge", block({quaternion_of(Vec3(0.7, 0.1, 0.3)), Vec3(0.003, -0.002, 0.04)},
                                   Vec3(0.03, 0.03, 0.03), {2, 2, 2}))};
    d.contacts = {contact("slab", "edge")};
    return d;
  }
  /// Returns a ball on a block's top, in its middle or at its edge.
  scene::Description ball(const std::string& name, double x) {
    scene::Description d;
    d.name = name;
    d.bodies = {body("block", block({Quat::Identity(), Vec3::Zero()}, Vec3(0.03, 0.03, 0.03), {2, 2, 2}))};
    ToolSpec tool;
    tool.radius_m = 0.006;
    tool.position_m = Vec3(x, 0.002, 0.022);
    d.tool = tool;
    d.device.emplace();
    d.device->keyframes = {{.position_m = tool.position_m}};
    d.contacts = {contact("block", "tool")};
    return d;
  }
  /// Returns a block face down on a slab, with samples at the few vertices of both.
  scene::Description few_vertices() {
    scene::Description d;
    d.name = "few vertices";
    const Pose above{Quat::Identity(), Vec3(0.0003, -0.0002, 0.03)};
    d.bodies = {body("slab", block({Quat::Identity(), Vec3::Zero()}, Vec3(0.06, 0.06, 0.02), {4, 4, 2}, 1)),
                body("block", block(above, Vec3(0.03, 0.03, 0.03), {2, 2, 2}, 1))};
    d.contacts = {contact("slab", "block")};
    return d;
  }
};

void expect_no_jumps(const scene::Description& scene, int paths) {
  bench::ContinuityOptions options;
  options.paths = paths;
  options.steps = 60;
  const bench::ContinuityRow row = bench::bench_continuity(scene, options);
  EXPECT_EQ(row.paths, paths) << scene.name;
  EXPECT_GT(row.steps, 10 * paths) << scene.name;
  int checked = 0;
  for (const bench::ForceJump& jump : row.jumps) {
    if (jump.size_n < kSeen * row.force) continue;
    ++checked;
    EXPECT_LT(jump.force, kBound) << scene.name << " path " << jump.path << " at " << jump.at;
    EXPECT_LT(jump.moment, 2.0 * kBound) << scene.name << " path " << jump.path << " at " << jump.at;
  }
  EXPECT_GT(checked, 10) << scene.name;  // Bisected steps.
}

}  // namespace

#ifdef PALPATE_HAS_TOOL
TEST(Continuity, ABallPressesAFlatBlockWithoutJumps) { expect_no_jumps(Blocks().ball("flat", 0.001), 3); }
TEST(Continuity, ABallGoesOverAnEdgeWithoutJumps) { expect_no_jumps(Blocks().ball("edge", 0.024), 3); }
#endif
TEST(Continuity, TheRidgeOfABlockPressesWithoutJumps) { expect_no_jumps(Blocks().ridge(), 6); }

// A point that is as near to the other block's side as to its face changes direction there, with its share of
// the force: with few points the shares are large.
TEST(Continuity, WhatJumpsIsFound) {
  bench::ContinuityOptions options;
  options.paths = 2;
  const bench::ContinuityRow row = bench::bench_continuity(Blocks().few_vertices(), options);
  EXPECT_GT(*std::max_element(row.worst_of_path.begin(), row.worst_of_path.end()), 2.0 * kBound);
}

TEST(Continuity, APathIsSmoothAndKeepsToItsReach) {
  std::mt19937 random(3);
  bench::Meeting meeting;
  meeting.pivot = Vec3(0.1, 0.2, -0.3);
  meeting.away = Vec3(0.0, 0.6, 0.8);
  meeting.reach = 0.2;
  for (int i = 0; i < 20; ++i) {
    const bench::RelativePath path(meeting, random);
    double most_in = 0.0, most_out = 0.0;
    for (int k = 0; k < 100; ++k) {
      const double s = 0.01 * k;
      const Vec3 here = path.at(s) * meeting.pivot, there = path.at(s + 0.01) * meeting.pivot;
      EXPECT_LT((there - here).norm(), 0.01 * 2.0 * 2.0 * M_PI * 0.2 * (0.02 + 2 * 0.06));
      const double along = meeting.away.dot(here - meeting.pivot);
      most_in = std::min(most_in, along);
      most_out = std::max(most_out, along);
      EXPECT_LT(rotation_vector(path.at(s).rotation).norm(), 0.1 * std::sqrt(3.0));
    }
    EXPECT_GE(most_in, -0.03 * meeting.reach);
    EXPECT_LE(most_out, 0.01 * meeting.reach + 1e-15);
    EXPECT_LT(most_in, 0.0);
  }
}

TEST(Continuity, WhatHasNoContactIsRefused) {
  scene::Description d;
  d.name = "nothing";
  try {
    bench::bench_continuity(d, {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("scene \"nothing\" has no contact"), std::string::npos)
        << error.what();
  }
}
