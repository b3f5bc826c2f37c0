// Proxies swept by their velocity: contact that occurs within a time is found, however large the distance is
// now, and nothing else.
#include <gtest/gtest.h>

#include "palpate/core/error.h"
#include "proxy/decompose_solid.h"
#include "proxy/pruner.h"
#include "pruning.h"
#include "shapes.h"

using namespace palpate;
using proxy::ProxySet;
using proxy::Pruner;
using namespace pruning;

namespace {

Vec3 random_vector(std::mt19937& random, double size) {
  std::normal_distribution<double> normal;
  return size * Vec3(normal(random), normal(random), normal(random));
}

/// Random velocities of a body that moves, rotates and stretches.
Points random_velocities(const Points& nodes, std::mt19937& random, double speed, double rate) {
  const Vec3 v = random_vector(random, speed);
  const Mat3 L = Mat3::NullaryExpr([&] { return random_vector(random, rate).x(); });
  Points out = L * nodes;
  return out.colwise() + v;
}

/// Returns whether the bound `all` includes all motions of `one`.
bool holds_motion(const proxy::ProxyMotion& all, const proxy::ProxyMotion& one) {
  return (one.velocity - all.velocity).norm() + one.spread <= all.spread;
}

/// A slab around z = 0, with its faces at +-thickness / 2.
LayeredModel slab(double width, double thickness) {
  LayeredModel model;
  model.name = "slab";
  model.skin = mesh::box_surface(Vec3(width, width, thickness), {16, 16, 2});
  model.proxies = proxy::decompose_solid(model.skin);
  return model;
}

}  // namespace

TEST(Swept, AVelocityOfTheSkinIsWithinTheBound) {
  const LayeredModel ball = cut(bumpy_ball(1.0, 0.3, 9), 20);
  Placed a(ball);
  std::mt19937 random(3);
  for (unsigned i = 0; i < 10; ++i) {
    a.place({quaternion_of(random_vector(random, 1.0)), random_vector(random, 3.0)}, 0.1, i);
    EXPECT_TRUE(a.set.motion(0).velocity.isZero(0.0)) << "an update puts it to rest";
    const Points v = random_velocities(a.nodes, random, 2.0, i < 5 ? 0.0 : 1.0);
    a.set.set_motion(v);
    Points of_skin;
    mesh::evaluate(ball.embedding, ball.tets.tets, v, of_skin);
    double tightest = HUGE_VAL;
    for (std::size_t p = 0; p < ball.proxies.size(); ++p) {
      const proxy::ProxyMotion& motion = a.set.motion(static_cast<int>(p));
      for (const int vertex : ball.proxies[p].members) {
        const double off = (of_skin.col(vertex) - motion.velocity).norm();
        EXPECT_LE(off, motion.spread);
        tightest = std::min(tightest, motion.spread - off);
      }
      EXPECT_TRUE(holds_motion(a.set.widest_motion(), motion)) << i;
    }
    for (Eigen::Index vertex = 0; vertex < of_skin.cols(); ++vertex)
      EXPECT_LE((of_skin.col(vertex) - a.set.motion().velocity).norm(), a.set.motion().spread);
    if (i < 5) { EXPECT_LT(a.set.motion().spread, 1e-10) << "it moves as a whole"; }
    EXPECT_LT(tightest, 1.0);
  }
}

TEST(Swept, ARigidBodysTwistAndWayAreBounded) {
  const LayeredModel plate = slab(2.0, 0.3);
  ProxySet set(plate);
  std::mt19937 random(4);
  const Points& x = plate.skin.vertices;
  for (int i = 0; i < 10; ++i) {
    const Pose before{quaternion_of(random_vector(random, 1.0)), random_vector(random, 3.0)},
        now{quaternion_of(random_vector(random, 0.5)) * before.rotation, random_vector(random, 3.0)};
    const Twist twist{random_vector(random, 2.0), random_vector(random, 1.0)};
    set.update(now);
    for (const bool way : {false, true}) {
      if (way)
        set.set_motion_from(before);
      else
        set.set_motion(twist);
      double largest = 0.0;
      for (Eigen::Index v = 0; v < x.cols(); ++v) {
        const Vec3 moved = way ? Vec3(now * Vec3(x.col(v)) - before * Vec3(x.col(v)))
                               : twist.at(now.rotation * Vec3(x.col(v)));
        largest = std::max(largest, (moved - set.motion().velocity).norm());
        bool within_one = false;
        for (int p = 0; p < set.size(); ++p)
          within_one |= (moved - set.motion(p).velocity).norm() <= set.motion(p).spread;
        EXPECT_TRUE(within_one);
      }
      for (int p = 0; p < set.size(); ++p) EXPECT_TRUE(holds_motion(set.widest_motion(), set.motion(p))) << i;
      EXPECT_LE(largest, set.motion().spread);
      EXPECT_GT(largest, 0.3 * set.motion().spread) << "nor far from it";
    }
  }
}

// Brute force: bodies at random poses and velocities are moved forward in small steps, and every face with a
// vertex that enters the other body is in a region at the start.
TEST(Swept, WhatComesToTouchIsFound) {
  const LayeredModel ball = cut(bumpy_ball(1.0, 0.3, 9), 20),
                     small = cut(bumpy_ball(0.4, 0.2, 7, 0.1, 5), 12);
  Placed a(ball), b(small);
  Pruner pruner(a.set, b.set);
  std::mt19937 random(6);
  int touched_later = 0, apart_before = 0;
  constexpr double kTime = 0.1;
  for (unsigned i = 0; i < 12; ++i) {
    const Vec3 side = random_vector(random, 1.0).normalized();
    a.place({quaternion_of(random_vector(random, 1.0)), Vec3::Zero()}, i % 3 * 0.05, 2 * i);
    b.place({quaternion_of(random_vector(random, 1.0)), (1.5 + 0.1 * i) * side}, i % 2 * 0.04, 2 * i + 1);
    const Points va = random_velocities(a.nodes, random, 0.5, 1.0);
    Points vb = random_velocities(b.nodes, random, 1.0, 1.0);
    vb.colwise() -= 20.0 * side;
    a.set.set_motion(va);
    b.set.set_motion(vb);
    const Handed found = handed(pruner.query(0.0, kTime));
    Points skin_a, skin_b, speed_a, speed_b;
    mesh::evaluate(ball.embedding, ball.tets.tets, va, speed_a);
    mesh::evaluate(small.embedding, small.tets.tets, vb, speed_b);
    for (int step = 0; step <= 4; ++step) {
      const double t = kTime * step / 4;
      skin_a = a.skin + t * speed_a;
      skin_b = b.skin + t * speed_b;
      const auto faces_a = true_patch(ball.skin.faces, skin_a, small.skin.faces, skin_b),
                 faces_b = true_patch(small.skin.faces, skin_b, ball.skin.faces, skin_a);
      EXPECT_TRUE(holds(found.a, faces_a)) << i << " at " << t;
      EXPECT_TRUE(holds(found.b, faces_b)) << i << " at " << t;
      if (step == 0)
        apart_before += faces_a.empty() && faces_b.empty();
      else
        touched_later += step == 4 || !faces_a.empty();
    }
    EXPECT_FALSE(found.a_twice);
  }
  EXPECT_GT(apart_before, 6);
  EXPECT_GT(touched_later, 12);
}

// A ball above a slab at a distance d: a region is found exactly if v t reaches d, from 0.1 to 100 m/s, and
// none if it moves away or past. The region's gap is v t, its approach v.
TEST(Swept, ABallIsFoundBeforeContactIffItGetsThere) {
  const LayeredModel ball = cut(bumpy_ball(0.05, 0.015, 8, 0.0), 12), plate = slab(0.4, 0.01);
  Placed a(ball);
  ProxySet b(plate);
  Pruner pruner(a.set, b);
  double slack = 0.0;  // inflation of the hulls beyond their contents
  for (const ProxySet* set : {&a.set, &b}) {
    double most = 0.0;
    for (int p = 0; p < set->size(); ++p) most = std::max(most, set->state(p).inflation);
    slack += most;
  }
  EXPECT_LT(slack, 0.005);
  for (const double speed : {0.1, 1.0, 10.0, 100.0})
    for (const double time : {1e-4, 1e-2}) {
      const double way = speed * time;
      for (const double part : {0.98, 1.02}) {
        a.place({Quat::Identity(), Vec3(0.01, 0.02, 0.055 + part * way + (part > 1.0 ? slack : 0.0))}, 0.0,
                0);
        const auto ask = [&](const Vec3& velocity) {
          a.set.set_motion(velocity.replicate(1, a.nodes.cols()));
          return pruner.query(1e-5, time);
        };
        const auto towards = ask(Vec3(0, 0, -speed));
        EXPECT_EQ(!towards.empty(), part < 1.0) << speed << " m/s, " << time << " s";
        for (const auto& region : towards) {
          EXPECT_GT(region.region.normal.z(), 0.95);
          EXPECT_NEAR(region.gap, std::max(1e-5, region.region.normal.z() * way), 1e-9 * way + 1e-9);
          EXPECT_NEAR(region.approach, region.region.normal.z() * speed, 1e-9 * speed);
          EXPECT_NEAR(region.thickness, 0.01, 1e-9);
          if (way > 0.005) {  // all of the ball is within reach of the slab; trailing skin does not count
            EXPECT_EQ(region.region.method, proxy::RegionMethod::kAreas) << speed << " m/s, " << time << " s";
          }
          EXPECT_LE(region.apart, part * way + 1e-6);
          EXPECT_FALSE(region.faces_a.empty() || region.faces_b.empty());
        }
        if (part * way < slack) continue;
        EXPECT_TRUE(ask(Vec3(0, 0, speed)).empty());
        EXPECT_TRUE(ask(Vec3(speed, 0, 0)).empty());
      }
    }
}

// The slab moves instead, with a rigid body's twist.
TEST(Swept, EitherBodyMayBeTheOneThatMoves) {
  const LayeredModel ball = cut(bumpy_ball(0.05, 0.015, 8, 0.0), 12), plate = slab(0.4, 0.01);
  Placed a(ball);
  ProxySet b(plate);
  a.place({Quat::Identity(), Vec3(0, 0, 0.08)}, 0.0, 0);
  Pruner pruner(a.set, b);
  EXPECT_TRUE(pruner.query(1e-3, 0.01).empty());
  b.set_motion(Twist{Vec3::Zero(), Vec3(0, 0, 3.0)});
  EXPECT_FALSE(pruner.query(1e-3, 0.01).empty());
  EXPECT_EQ(pruner.counts().regions_ahead, 1);
  EXPECT_TRUE(pruner.query(1e-3, 0.005).empty());
  // rotates about the y axis, 0.3 away along x: the part under the ball rises at 0.3 omega
  b.set_motion(Twist{Vec3(0, 10.0, 0), Vec3(0, 0, 3.0)});
  EXPECT_FALSE(pruner.query(1e-3, 0.01).empty());
  a.set.set_motion(Vec3(0, 0, 3.0).replicate(1, a.nodes.cols()));
  b.set_motion(Twist{Vec3::Zero(), Vec3(0, 0, 3.0)});
  EXPECT_TRUE(pruner.query(1e-3, 0.01).empty()) << "they move together";
}

// Two balls of one body above a slab, one at rest and one falling: only the region of the falling one looks
// ahead.
TEST(Swept, ARegionsGapIsThatOfItsOwnProxies) {
  LayeredModel one = bumpy_ball(0.05, 0.015, 8, 0.0);
  LayeredModel two = one;
  const Eigen::Index n = one.tets.nodes.cols(), v = one.skin.vertices.cols();
  const auto twice = [](auto& cells, Eigen::Index more) {
    const Eigen::Index m = cells.cols();
    cells.conservativeResize(Eigen::NoChange, 2 * m);
    cells.rightCols(m) = cells.leftCols(m).array() + static_cast<int>(more);
  };
  const auto beside = [](Points& x) {
    const Eigen::Index m = x.cols();
    x.conservativeResize(3, 2 * m);
    x.rightCols(m) = x.leftCols(m).colwise() + Vec3(0.15, 0, 0);
  };
  beside(two.tets.nodes);
  beside(two.skin.vertices);
  twice(two.tets.tets, n);
  twice(two.skin.faces, v);
  two.embedding = mesh::embed(two.tets, two.skin.vertices);
  two = cut(two, 24);
  const LayeredModel plate = slab(0.8, 0.01);
  Placed a(two);
  ProxySet b(plate);
  a.place({Quat::Identity(), Vec3(0, 0, 0.055 + 0.0005)}, 0.0, 0);
  Points velocities = Points::Zero(3, 2 * n);
  velocities.rightCols(n).row(2).setConstant(-2.0);
  a.set.set_motion(velocities);
  Pruner pruner(a.set, b);
  int at_rest = 0, falling = 0;
  for (const auto& region : pruner.query(2e-3, 0.01)) {
    const bool falls = a.set.centre(region.pairs.front().first).x() > 0.075;
    ++(falls ? falling : at_rest);
    EXPECT_NEAR(region.gap, falls ? 0.02 * region.region.normal.z() : 2e-3, 1e-9);
    EXPECT_NEAR(region.approach, falls ? 2.0 * region.region.normal.z() : 0.0, 1e-9);
  }
  EXPECT_GE(at_rest, 1);
  EXPECT_GE(falling, 1);
}

// If nothing moves, or everything moves together, regions are bitwise equal to those of a query without time.
TEST(Swept, WithoutMotionTimeChangesNothing) {
  const LayeredModel ball = cut(bumpy_ball(1.0, 0.2, 12, 0.0), 30);
  Placed a(ball), b(ball);
  b.place({Quat::Identity(), Vec3(0.3, 0.2, -1.85)}, 0.02, 1);
  Pruner with(a.set, b.set), without(a.set, b.set);
  for (int i = 0; i < 2; ++i) {
    const auto one = with.query(0.02, 0.01), other = without.query(0.02);
    ASSERT_EQ(one.size(), other.size());
    for (std::size_t r = 0; r < one.size(); ++r) {
      EXPECT_EQ(one[r].region.normal, other[r].region.normal);
      EXPECT_EQ(one[r].faces_a, other[r].faces_a);
      EXPECT_EQ(one[r].faces_b, other[r].faces_b);
      EXPECT_EQ(one[r].gap, 0.02);
    }
  }
}

// Path of a ball that passed through a slab: all faces in contact on its way, by brute force along it. Motion
// shorter than a fraction of the slab is skipped.
TEST(Swept, WhatMetOnTheWayIsFound) {
  const LayeredModel ball = cut(bumpy_ball(0.05, 0.015, 8, 0.0), 12), plate = slab(0.4, 0.01);
  Placed a(ball);
  ProxySet b(plate);
  Pruner pruner(a.set, b);
  std::vector<int> faces_a, faces_b;
  const Vec3 from(0.02, 0.01, 0.08), to(-0.03, 0.02, -0.09);
  a.place({Quat::Identity(), from}, 0.0, 0);
  const Points skin_before = a.skin, nodes_before = a.nodes;
  a.place({Quat::Identity(), to}, 0.0, 0);
  a.set.set_motion(Points(a.nodes - nodes_before));
  pruner.met_on_the_way(faces_a, faces_b);
  const std::set<int> found_a(faces_a.begin(), faces_a.end()), found_b(faces_b.begin(), faces_b.end());
  int met = 0;
  for (int i = 0; i <= 20; ++i) {
    const Points skin = skin_before + i / 20.0 * (a.skin - skin_before);
    const auto of_a = true_patch(ball.skin.faces, skin, plate.skin.faces, plate.skin.vertices),
               of_b = true_patch(plate.skin.faces, plate.skin.vertices, ball.skin.faces, skin);
    EXPECT_TRUE(holds(found_a, of_a));
    EXPECT_TRUE(holds(found_b, of_b));
    met += !of_a.empty();
  }
  EXPECT_GT(met, 5);
  EXPECT_LT(found_b.size(), static_cast<std::size_t>(plate.skin.faces.cols()));
  EXPECT_EQ(pruner.counts().after_boxes, 0) << "the counts are those of queries";

  a.place({Quat::Identity(), Vec3(0, 0, 0.056)}, 0.0, 0);
  const Points near = a.nodes;
  a.place({Quat::Identity(), Vec3(0, 0, 0.055)}, 0.0, 0);
  a.set.set_motion(Points(a.nodes - near));
  pruner.met_on_the_way(faces_a, faces_b);
  EXPECT_TRUE(faces_a.empty() && faces_b.empty());
}

TEST(Swept, RefusesBadArguments) {
  const LayeredModel ball = cut(bumpy_ball(1.0, 0.4, 6), 4), plate = slab(1.0, 0.1);
  ProxySet soft(ball), rigid(plate);
  EXPECT_THROW(soft.set_motion(Twist{}), InternalError);
  EXPECT_THROW(rigid.set_motion(Points(Points::Zero(3, 4))), InternalError);
  EXPECT_THROW(soft.set_motion(Points(Points::Zero(3, 4))), InternalError);
  Points bad = Points::Zero(3, ball.tets.nodes.cols());
  bad(0, 3) = NAN;
  EXPECT_THROW(soft.set_motion(bad), InternalError);
  Pruner pruner(soft, rigid);
  EXPECT_THROW(pruner.query(0.1, -1.0), InternalError);
}
