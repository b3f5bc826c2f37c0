#include "proxy/proxy_set.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "palpate/core/error.h"
#include "proxy/decompose.h"
#include "proxy/hull.h"
#include "shapes.h"

using namespace palpate;
using proxy::Follow;
using proxy::ProxySet;

namespace {

struct Deformation {
  const char* name;
  std::function<Vec3(const Vec3&)> map;
};

/// Deformations from gentle to impossible. The scattered ones are not even continuous: every node moves
/// independently.
std::vector<Deformation> deformations() {
  auto random = std::make_shared<std::mt19937>(17);
  const auto noise = [random](double reach) {
    std::uniform_real_distribution<double> in(-reach, reach);
    return Vec3(in(*random), in(*random), in(*random));
  };
  const auto twist = [](const Vec3& x, double rate) {
    const double angle = rate * x.z();
    return Vec3(std::cos(angle) * x.x() - std::sin(angle) * x.y(),
                std::sin(angle) * x.x() + std::cos(angle) * x.y(), x.z());
  };
  return {{"rest", [](const Vec3& x) { return x; }},
          {"moved far", [](const Vec3& x) { return Vec3(x + Vec3(1000, -2000, 500)); }},
          {"jitter", [=](const Vec3& x) { return Vec3(x + noise(0.02)); }},
          {"squashed", [](const Vec3& x) { return Vec3(x.x(), x.y(), 0.01 * x.z()); }},
          {"flat", [](const Vec3& x) { return Vec3(x.x(), x.y(), 0.0); }},
          {"a point", [](const Vec3&) { return Vec3(1, 2, 3); }},
          {"inverted", [](const Vec3& x) { return Vec3(-x); }},
          {"mirrored", [](const Vec3& x) { return Vec3(x.x(), -x.y(), x.z()); }},
          {"stretched", [](const Vec3& x) { return Vec3(5 * x.x(), x.y(), x.z()); }},
          {"twisted", [=](const Vec3& x) { return twist(x, 3.0); }},
          {"bent",
           [](const Vec3& x) {
             return Vec3((2 + x.y()) * std::sin(x.x() / 2), (2 + x.y()) * std::cos(x.x() / 2) - 2, x.z());
           }},
          {"turned inside out", [](const Vec3& x) { return Vec3(x / std::max(0.1, x.squaredNorm())); }},
          {"scattered", [=](const Vec3&) { return noise(3.0); }},
          {"exploded", [=](const Vec3& x) { return Vec3(100 * x + noise(50.0)); }}};
}

Points deformed(const LayeredModel& model, const Deformation& how) {
  Points out = model.tets.nodes;
  for (Eigen::Index i = 0; i < out.cols(); ++i) out.col(i) = how.map(Vec3(out.col(i)));
  return out;
}

double distance_to(const ProxySet& set, int p, const Vec3& x) {
  Points corners(3, set.corner_count(p));
  set.copy_corners(p, corners);
  const Points one = x;
  return proxy::nearest_difference(proxy::Hull(one), proxy::Hull(corners)).norm();
}

LayeredModel decomposed(LayeredModel model, int count) {
  model.proxies = proxy::decompose(model, {.count = count});
  return model;
}

}  // namespace

// Invariant: for any node positions, every skin vertex is in the inflated hull of each of its proxies, in its
// box, and in its patches' balls; and every tetrahedron is in its owner's.
TEST(ProxySet, NothingLeavesItsProxyUnderAnyDeformation) {
  LayeredModel bar = bar_on_bones({8, 3, 2});
  for (Eigen::Index n = 0; n < bar.tets.nodes.cols(); ++n) {
    const Vec3 x = bar.tets.nodes.col(n);
    bar.bone_of_node.push_back(std::hypot(x.y(), x.z()) < 0.2 ? (x.x() < 0 ? 0 : 1) : -1);
  }
  long checked = 0;
  for (const LayeredModel& model : {decomposed(bumpy_ball(1.0, 0.3, 14), 12), decomposed(bar, 6)})
    for (const Follow follow : {Follow::kAffine, Follow::kRigid}) {
      ProxySet set(model, {.follow = follow});
      for (const Deformation& how : deformations()) {
        const Points nodes = deformed(model, how);
        set.update(nodes);
        Points skin;
        mesh::evaluate(model.embedding, model.tets.tets, nodes, skin);
        const double room = 1e-9 * (1.0 + nodes.cwiseAbs().maxCoeff());
        for (int p = 0; p < set.size(); ++p) {
          const auto& state = set.state(p);
          for (const int v : model.proxies[static_cast<std::size_t>(p)].members) {
            ASSERT_LE(distance_to(set, p, skin.col(v)), state.inflation + room)
                << how.name << ", proxy " << p << ", vertex " << v;
            ASSERT_TRUE((skin.col(v).array() >= state.low.array() - room).all() &&
                        (skin.col(v).array() <= state.high.array() + room).all())
                << how.name;
            ++checked;
          }
        }
        for (const auto& patch : set.patches()) {
          const proxy::Ball ball = set.ball(patch);
          for (const int f : set.faces(patch))
            for (int k = 0; k < 3; ++k)
              ASSERT_LE((skin.col(model.skin.faces(k, f)) - ball.centre).norm(), ball.radius + room)
                  << how.name;
        }
        const auto root = set.tree()[0];
        for (Eigen::Index n = 0; n < nodes.cols(); ++n)
          ASSERT_TRUE((nodes.col(n).array() >= root.low.array() - room).all() &&
                      (nodes.col(n).array() <= root.high.array() + room).all())
              << how.name;
      }
    }
  EXPECT_GT(checked, 50000);
}

// Affine motions cause no inflation of the affine follower, nor do rigid ones; a stretch by 1 + s inflates
// the rigid follower by about s times the proxy's half size.
TEST(ProxySet, WhatFollowsExactlyInflatesNoMore) {
  const LayeredModel model = decomposed(bumpy_ball(1.0, 0.3, 14), 12);
  ProxySet affine(model), rigid(model, {.follow = Follow::kRigid});
  std::vector<double> rest;
  for (int p = 0; p < affine.size(); ++p) rest.push_back(affine.state(p).inflation);
  const Mat3 R = Eigen::AngleAxisd(2.0, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const Points rotated = (R * model.tets.nodes).colwise() + Vec3(3, -1, 2);
  affine.update(rotated);
  rigid.update(rotated);
  for (int p = 0; p < affine.size(); ++p) {
    EXPECT_LT((affine.state(p).linear - R).norm(), 1e-11);
    EXPECT_LT((rigid.state(p).linear - R).norm(), 1e-11);
    EXPECT_NEAR(affine.state(p).inflation, rest[static_cast<std::size_t>(p)], 1e-9);
    EXPECT_NEAR(rigid.state(p).inflation, rest[static_cast<std::size_t>(p)], 1e-9);
  }
  Mat3 S = Mat3::Identity();
  S(0, 0) = 1.2;
  const Points stretched = S * model.tets.nodes;
  affine.update(stretched);
  rigid.update(stretched);
  for (int p = 0; p < affine.size(); ++p) {
    EXPECT_NEAR(affine.state(p).stretch, 1.2, 1e-9);
    EXPECT_NEAR(affine.state(p).inflation, 1.2 * rest[static_cast<std::size_t>(p)], 1e-9);
    const auto& corners = model.proxies[static_cast<std::size_t>(p)].corners;
    const double extent = corners.row(0).maxCoeff() - corners.row(0).minCoeff();
    // the end farther from the nodes' centre
    EXPECT_GT(rigid.state(p).inflation - rest[static_cast<std::size_t>(p)], 0.2 * 0.4 * extent);
  }
}

// A bend with strains up to a half: the bound against the largest distance of a member from its position
// under the hull's motion. The map's second derivative is at most 1.25 (3/4 along x twice, 1/2 along x and
// y), so that over a proxy of diameter L an affine map has an error of at most 1.25 L^2 / 8 (Taylor, from the
// centre); a rotation has the strain's error as well.
TEST(ProxySet, BoundsAreTightForModerateDeformations) {
  const LayeredModel model = decomposed(bumpy_ball(1.0, 0.2, 24), 60);
  ProxySet affine(model), rigid(model, {.follow = Follow::kRigid});
  int checked = 0;
  double affine_sum = 0.0;
  for (const Deformation& how : deformations()) {
    if (std::string_view(how.name) != "bent") continue;
    const Points nodes = deformed(model, how);
    Points skin;
    mesh::evaluate(model.embedding, model.tets.tets, nodes, skin);
    for (ProxySet* set : {&affine, &rigid}) {
      set->update(nodes);
      double sum = 0.0, largest = 0.0, ratio = 0.0, allowed = 0.0;
      for (int p = 0; p < set->size(); ++p) {
        const auto& state = set->state(p);
        double moved = 0.0;
        for (const int v : model.proxies[static_cast<std::size_t>(p)].members)
          moved = std::max(moved,
                           (skin.col(v) - state.linear * model.skin.vertices.col(v) - state.offset).norm());
        const auto& corners = model.proxies[static_cast<std::size_t>(p)].corners;
        double diameter = 0.0;
        for (Eigen::Index c = 0; c < corners.cols(); ++c)
          diameter = std::max(diameter, (corners.colwise() - corners.col(c)).colwise().norm().maxCoeff());
        allowed += 1.25 / 8 * diameter * diameter;
        sum += state.inflation;
        largest = std::max(largest, state.inflation);
        ratio += state.inflation / (moved + 0.02) / set->size();
        ++checked;
      }
      RecordProperty(set == &affine ? "affine_mean_inflation_um" : "rigid_mean_inflation_um",
                     static_cast<int>(1e6 * sum / set->size()));
      RecordProperty(set == &affine ? "affine_largest_inflation_um" : "rigid_largest_inflation_um",
                     static_cast<int>(1e6 * largest));
      EXPECT_LT(ratio, 3.0);
      if (set == &affine) {
        EXPECT_LT(sum, allowed + 0.01 * set->size());  // plus the part outside at rest
        affine_sum = sum;
      } else {
        EXPECT_LT(affine_sum, 0.6 * sum);
      }
    }
  }
  EXPECT_EQ(checked, 120);
}

// A bone's proxy moves with the nodes that the bone carries, wherever the tissue is.
TEST(ProxySet, ABonesProxiesFollowItsNodes) {
  LayeredModel model = bar_on_bones({8, 3, 2});
  for (Eigen::Index n = 0; n < model.tets.nodes.cols(); ++n) {
    const Vec3 x = model.tets.nodes.col(n);
    model.bone_of_node.push_back(std::hypot(x.y(), x.z()) < 0.28 ? (x.x() < -0.01  ? 0
                                                                    : x.x() > 0.01 ? 1
                                                                                   : -1)
                                                                 : -1);
  }
  ASSERT_GE(std::count(model.bone_of_node.begin(), model.bone_of_node.end(), 0), 4);
  model.proxies = proxy::decompose(model, {.count = 4});
  ProxySet set(model, {.follow = Follow::kRigid});
  const Mat3 R = Eigen::AngleAxisd(0.7, Vec3::UnitY()).toRotationMatrix();
  Points nodes = model.tets.nodes;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> in(-0.1, 0.1);
  for (Eigen::Index n = 0; n < nodes.cols(); ++n)
    if (const int bone = model.bone_of_node[static_cast<std::size_t>(n)]; bone == 1)
      nodes.col(n) = R * nodes.col(n);
    else if (bone < 0)
      nodes.col(n) += Vec3(in(random), in(random), in(random));
  set.update(nodes);
  for (int p = 0; p < set.size(); ++p)
    EXPECT_LT((set.state(p).linear - (set.bone(p) == 1 ? R : Mat3(Mat3::Identity()))).norm(), 1e-10);
}

TEST(ProxySet, RigidBodiesFollowTheirPose) {
  LayeredModel model;
  model.skin = mesh::sphere(0.5, 10);
  model.proxies = proxy::decompose(model, {.count = 1});
  ProxySet set(model);
  Pose pose{Quat(Eigen::AngleAxisd(1.0, Vec3::UnitX())), Vec3(1, 2, 3)};
  set.update(pose);
  EXPECT_LT((set.centre(0) - (pose * Vec3(model.proxies[0].corners.rowwise().mean()))).norm(), 1e-14);
  for (Eigen::Index v = 0; v < model.skin.vertices.cols(); ++v)
    EXPECT_LE(distance_to(set, 0, pose * Vec3(model.skin.vertices.col(v))), set.state(0).inflation + 1e-12);
  EXPECT_LT(set.state(0).inflation, 0.1);
  EXPECT_THROW(set.update(model.skin.vertices), InternalError);
}

TEST(ProxySet, TheTreeFollowsTheSkeleton) {
  const LayeredModel model = decomposed(bar_on_bones({8, 3, 2}), 8);
  ProxySet set(model);
  const auto tree = set.tree();
  EXPECT_EQ(tree[0].after, static_cast<int>(tree.size()));
  std::vector<int> seen;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    if (tree[i].proxy >= 0) seen.push_back(tree[i].proxy);
    if (i > 0) { EXPECT_LT(tree[i].parent, static_cast<int>(i)); }
  }
  std::sort(seen.begin(), seen.end());
  for (int p = 0; p < set.size(); ++p) EXPECT_EQ(seen[static_cast<std::size_t>(p)], p);
  EXPECT_EQ(tree[1].proxy, -1);  // bone "left": its proxies, then bone "right" with its proxies
  EXPECT_EQ(tree[1].after, static_cast<int>(tree.size()));
}

TEST(ProxySet, RefusesWhatIsIncompleteOrNotFinite) {
  LayeredModel model = bar_on_bones({2, 1, 1});
  EXPECT_THROW(ProxySet{model}, Error);
  model.proxies = proxy::decompose(model, {.count = 4});
  ProxySet set(model);
  Points nodes = model.tets.nodes;
  nodes(1, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(set.update(nodes), InternalError);
  EXPECT_THROW(set.update(Points(nodes.leftCols(3))), InternalError);
  EXPECT_THROW(set.update(Pose{}), InternalError);
  EXPECT_THROW(ProxySet(model, {.patch_faces = -1}), Error);
  model.proxies[2].members.clear();
  EXPECT_THROW(ProxySet{model}, Error);
}
