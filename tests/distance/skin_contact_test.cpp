// Contact energy of two skins: laws worked out by hand, gradient, equilibrium, history, memory.
#include "malloc_count.h"

#include "bodies.h"

using namespace distance_tests;

namespace {

constexpr double kStiffness = 1e6;  // [Pa/m]
constexpr double kRadius = 0.05;

/// Force on a sphere that is pressed by `depth` into the top of a box, divided by pi k R depth^2.
double ratio_to_law(const Body& sphere, const Body& box, bool two_sided, bool of_box, double depth) {
  Body ball = sphere;
  ball.place(rotation({0.4, 0.3, 0.2}), {0.003, 0.002, 0.1 + kRadius - depth});
  SkinContact contact(of_box ? box.skin : ball.skin, of_box ? ball.skin : box.skin,
                      {.stiffness_pa_m = kStiffness, .two_sided = two_sided});
  contact.find(of_box ? box.at() : ball.at(), of_box ? ball.at() : box.at());
  const Vec3 force = (of_box ? -1 : 1) * contact.resultant().force;
  EXPECT_LT(force.head<2>().norm(), 2e-3 * force.z());
  return force.z() / (M_PI * kStiffness * kRadius * depth * depth);
}

}  // namespace

// With d the depth at angle t from the lowest point, d = delta - R (1 - cos t), the sphere's points give k
// integral of d dA = 2 pi k R^2 integral over c = cos t of (delta - R (1 - c)) = pi k R delta^2. A point of
// the plane at distance s from the centre, h = R - delta, is pushed by R - s along its radius: k integral of
// (R - s) h/s 2 pi s ds over h < s < R = pi k (R - delta) delta^2. Half of each: pi k R delta^2 (1 - delta/(2
// R)). The volume is pi delta^2 (R - delta/3), so the first is 1/(1 - delta/(3 R)) times k times the volume.
TEST(SkinContact, SphereOnPlane) {
  const Body sphere = shell(mesh::sphere(kRadius, 48));
  const Body box = shell(mesh::box_surface({0.2, 0.2, 0.2}, {128, 128, 1}));
  for (const double depth : {0.005, 0.01}) {
    EXPECT_NEAR(ratio_to_law(sphere, box, false, false, depth), 1.0, 0.01);
    EXPECT_NEAR(ratio_to_law(sphere, box, false, true, depth), 1.0 - depth / kRadius, 0.01);
    EXPECT_NEAR(ratio_to_law(sphere, box, true, false, depth), 1.0 - 0.5 * depth / kRadius, 0.01);
  }
}

// A polyhedron inscribed in a sphere lies inside it by up to h^2/(8 R); the force therefore has a
// second-order error.
TEST(SkinContact, ForceConvergesToSecondOrderInTheMesh) {
  const Body box = shell(mesh::box_surface({0.2, 0.2, 0.2}, {2, 2, 1}));
  double error[3];
  for (int i = 0; i < 3; ++i)
    error[i] = std::abs(ratio_to_law(shell(mesh::sphere(kRadius, 12 << i)), box, false, false, 0.01) - 1.0);
  for (int i = 0; i < 2; ++i) {
    EXPECT_GT(std::log2(error[i] / error[i + 1]), 1.8);
    EXPECT_LT(std::log2(error[i] / error[i + 1]), 2.3);
  }
}

TEST(SkinContact, PrintedQuadratureErrorBoundsTheTrueOne) {
  Pair pair;
  SkinContactSpec spec{.stiffness_pa_m = kStiffness};
  SkinContact once(pair.a.skin, pair.b.skin, spec);
  spec.spacing_m = {0.25 * pair.a.skin.longest_edge.minCoeff(), 0.25 * pair.b.skin.longest_edge.minCoeff()};
  SkinContact refined(pair.a.skin, pair.b.skin, spec);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> turn(-0.2, 0.2), shift(-0.004, 0.004);
  int bounded = 0, all = 0;
  for (int i = 0; i < 100; ++i) {
    pair.b.place(rotation({turn(random), -0.8 + turn(random), turn(random)}),
                 {0.166 + shift(random), 0.01 + shift(random), shift(random)});
    once.find(pair.a.at(), pair.b.at());
    refined.find(pair.a.at(), pair.b.at());
    const Vec3 exact = refined.resultant().force;
    ASSERT_GT(exact.norm(), 0.0);
    const double error = (once.resultant().force - exact).norm();
    EXPECT_LT(error, 0.05 * exact.norm());
    bounded += error <= once.quadrature_error();
    ++all;
  }
  EXPECT_GE(bounded, 95 * all / 100);
}

TEST(SkinContact, ForceIsTheGradientOfTheEnergy) {
  Pair pair;
  for (const bool two_sided : {true, false}) {
    SkinContact contact(pair.a.skin, pair.b.skin, {.stiffness_pa_m = kStiffness, .two_sided = two_sided});
    Points fa, fb;
    const double energy = contact_force(contact, pair.a, pair.b, fa, fb);
    ASSERT_GT(contact.springs().size(), 50u);
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    Points va(3, fa.cols()), vb(3, fb.cols());
    for (double& x : va.reshaped()) x = normal(random);
    for (double& x : vb.reshaped()) x = normal(random);
    const double slope = -(fa.cwiseProduct(va).sum() + fb.cwiseProduct(vb).sum());
    double before = 0.0;
    int steps = 0;
    for (double h = 8e-6; h > 2e-7; h *= 0.5) {
      Body a = pair.a, b = pair.b;
      a.nodes += h * va;
      b.nodes += h * vb;
      contact.find(a.at(), b.at());
      const double rest = std::abs(contact.energy() - energy - h * slope);
      if (before > 0.0) {
        EXPECT_GT(std::log2(before / rest), 1.8) << h;
        EXPECT_LT(std::log2(before / rest), 2.3) << h;
        ++steps;
      }
      before = rest;
    }
    EXPECT_EQ(steps, 5);
  }
}

TEST(SkinContact, ForcesAndMomentsBalanceToRounding) {
  Pair pair;
  SkinContact contact(pair.a.skin, pair.b.skin, {.stiffness_pa_m = kStiffness});
  Points fa, fb;
  contact_force(contact, pair.a, pair.b, fa, fb);
  const Vec3 force = fa.rowwise().sum(), moment = moment_of(pair.a.nodes, fa);
  ASSERT_GT(force.norm(), 0.1);
  EXPECT_LT((force + fb.rowwise().sum()).norm(), 1e-13 * force.norm());
  EXPECT_LT((moment + moment_of(pair.b.nodes, fb)).norm(), 1e-14 * force.norm());
  EXPECT_LT((contact.resultant().force - force).norm(), 1e-13 * force.norm());
  EXPECT_LT((contact.resultant().moment - moment).norm(), 1e-14 * force.norm());
}

// Exact spheres have no torque about their centres. With two inscribed polyhedra, the line through each foot
// misses the centre by up to R times the angle between face and sphere, h/(2 R), equally often on either
// side.
TEST(SkinContact, SpheresFeelNoTorque) {
  const Body a = shell(mesh::sphere(0.05, 40));
  Body b = shell(mesh::sphere(0.04, 40));
  const SkinContactSpec spec{
      .stiffness_pa_m = kStiffness,
      .spacing_m = {0.5 * a.skin.longest_edge.maxCoeff(), 0.5 * b.skin.longest_edge.maxCoeff()}};
  SkinContact contact(a.skin, b.skin, spec);
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 5; ++i) {
    const Vec3 way = Vec3(normal(random), normal(random), normal(random)).normalized();
    b.place(rotation({0.1 * i, 0.3, -0.2 * i}), 0.085 * way);
    contact.find(a.at(), b.at());
    const Resultant r = contact.resultant();
    EXPECT_LT(r.moment.norm(), 2e-5 * r.force.norm());  // [m]
    EXPECT_LT(r.force.normalized().cross(way).norm(), 2e-3);
    EXPECT_LT(r.force.dot(way), 0.0);
  }
}

// Exchanging the two bodies swaps the roles of the two skins and changes nothing else.
TEST(SkinContact, OrderOfTheBodiesChangesRoundingAlone) {
  Pair pair;
  SkinContact one(pair.a.skin, pair.b.skin, {.stiffness_pa_m = kStiffness});
  SkinContact other(pair.b.skin, pair.a.skin, {.stiffness_pa_m = kStiffness});
  one.find(pair.a.at(), pair.b.at());
  other.find(pair.b.at(), pair.a.at());
  EXPECT_EQ(one.springs().size(), other.springs().size());
  EXPECT_LT((one.resultant().force + other.resultant().force).norm(), 1e-13 * one.resultant().force.norm());
}

TEST(SkinContact, RigidMotionOfAllTurnsTheForce) {
  Pair pair;
  SkinContact contact(pair.a.skin, pair.b.skin, {.stiffness_pa_m = kStiffness});
  contact.find(pair.a.at(), pair.b.at());
  const Resultant r = contact.resultant();
  const Mat3 R = rotation({1.0, -0.5, 0.7});
  for (Body* body : {&pair.a, &pair.b}) body->nodes = (R * body->nodes).colwise() + Vec3(0.5, -1, 2);
  contact.find(pair.a.at(), pair.b.at());
  EXPECT_LT((contact.resultant().force - R * r.force).norm(), 1e-10 * r.force.norm());
}

// A small body deep inside a large one, far from its surface everywhere: depth is not limited, and the
// nearest exit is found.
TEST(SkinContact, DeepPointsAreFoundHoweverFarTheSkinIs) {
  const Body large = shell(mesh::sphere(0.1, 24));
  Body small = shell(mesh::sphere(0.01, 6));
  small.place(Vec3(0.03, 0, 0));
  SkinContact contact(small.skin, large.skin, {.stiffness_pa_m = kStiffness, .two_sided = false});
  contact.find(small.at(), large.at());
  EXPECT_EQ(contact.springs().size(), contact.points(0).size());
  EXPECT_NEAR(contact.deepest(), 0.08, 1e-3);
  EXPECT_GT(contact.resultant().force.x(), 0.0);
}

TEST(SkinContact, ResultIsTheSameWhateverWasFoundBefore) {
  Pair pair;
  const SkinContactSpec spec{.stiffness_pa_m = kStiffness};
  SkinContact used(pair.a.skin, pair.b.skin, spec);
  std::mt19937 random(13);
  std::uniform_real_distribution<double> turn(-0.5, 0.5), shift(-0.02, 0.02);
  long springs = 0;
  for (int i = 0; i < 12; ++i) {
    pair.b.place(rotation({0.3 + turn(random), turn(random), turn(random)}),
                 {0.168 + 0.3 * shift(random), shift(random), shift(random)});
    SkinContact fresh(pair.a.skin, pair.b.skin, spec);
    Points f[2], g[2];
    EXPECT_EQ(contact_force(used, pair.a, pair.b, f[0], f[1]),
              contact_force(fresh, pair.a, pair.b, g[0], g[1]));
    EXPECT_EQ(f[0], g[0]);
    EXPECT_EQ(f[1], g[1]);
    springs += static_cast<long>(fresh.springs().size());
  }
  EXPECT_GT(springs, 500);
}

// Motion straight towards the other body: the approach alone consumes the clearance.
TEST(SkinContact, SmallStepsTowardsEachOtherMissNothing) {
  Pair pair;
  const SkinContactSpec spec{.stiffness_pa_m = kStiffness};
  SkinContact used(pair.a.skin, pair.b.skin, spec);
  std::size_t springs = 0;
  for (int i = 0; i < 16; ++i) {
    pair.b.place(rotation({0.3, -0.8, 0.4}), {0.19 - 0.002 * i, 0.01, -0.006});
    SkinContact fresh(pair.a.skin, pair.b.skin, spec);
    used.find(pair.a.at(), pair.b.at());
    fresh.find(pair.a.at(), pair.b.at());
    EXPECT_EQ(used.springs().size(), fresh.springs().size());
    EXPECT_EQ(used.energy(), fresh.energy());
    springs = fresh.springs().size();
  }
  EXPECT_GT(springs, 200u);
}

// Two balls approach along the diagonal: their boxes overlap well before their skins touch. Every cluster
// near the contact was found clear by up to 0.07 m, and is searched again only because of the approach.
TEST(SkinContact, AnApproachFromFarMissesNothing) {
  const Body a = shell(mesh::sphere(0.1, 24));
  Body b = a;
  const SkinContactSpec spec{.stiffness_pa_m = kStiffness};
  SkinContact used(a.skin, b.skin, spec);
  std::size_t springs = 0;
  for (int i = 0; i <= 40; ++i) {
    b.place(Vec3::Constant((0.28 - 0.0025 * i) / std::sqrt(3.0)));
    SkinContact fresh(a.skin, b.skin, spec);
    used.find(a.at(), b.at());
    fresh.find(a.at(), b.at());
    EXPECT_EQ(used.springs().size(), fresh.springs().size()) << "step " << i;
    EXPECT_EQ(used.energy(), fresh.energy()) << "step " << i;
    springs = fresh.springs().size();
  }
  EXPECT_GT(springs, 50u);
}

// Springs found 2 mm apart follow an approach along their line: once the first one can penetrate, it does,
// and the springs left out are outside.
TEST(SkinContact, SpringsThatFollowAnApproachMissNothing) {
  const Body a = shell(mesh::sphere(0.1, 24));
  Body b = a;
  const SkinContactSpec spec{.stiffness_pa_m = kStiffness};
  const Vec3 line = a.rest.col(0).normalized();  // a vertex of a approaches its mirror image
  const double low = std::abs((a.rest.transpose() * line).minCoeff());
  const auto place = [&](double gap) { b.place(Vec3(line * (0.1 + low + gap))); };
  for (const double depth : {1e-5, 1e-4, 1e-3}) {
    SkinContact follows(a.skin, b.skin, spec);
    place(2e-3);
    follows.find(a.at(), b.at(), 0.01);
    ASSERT_EQ(follows.energy(), 0.0);
    const auto near = follows.springs().size();
    place(-depth);
    SkinContact fresh(a.skin, b.skin, spec);
    fresh.find(a.at(), b.at());
    follows.follow(a.at(), b.at());
    ASSERT_GT(fresh.energy(), 0.0);
    EXPECT_EQ(follows.energy(), fresh.energy()) << depth;
    std::size_t left_out = 0;
    for (const Spring& spring : follows.springs()) left_out += !spring.is_placed;
    EXPECT_GT(left_out, near / 4) << "of " << near;
  }
}

// The packets' single precision selects a face; the foot is then that of the reference search, unless two
// places are equally near to within rounding.
TEST(SkinContact, FindEqualsTheReference) {
  std::mt19937 random(23);
  std::uniform_real_distribution<double> turn(-1.0, 1.0), shift(-0.01, 0.01);
  const auto compare = [&](const Body& a, Body& b, const Vec3& at, double scale, int cuts) {
    const SkinContactSpec spec{
        .stiffness_pa_m = kStiffness,
        .spacing_m = {a.skin.longest_edge.mean() / cuts, b.skin.longest_edge.mean() / cuts}};
    SkinContact fast(a.skin, b.skin, spec);
    SkinContact reference(a.skin, b.skin, spec);
    std::size_t springs = 0, elsewhere = 0;
    for (int i = 0; i < 6; ++i) {
      b.place(rotation({turn(random), turn(random), turn(random)}),
              at + scale * Vec3(shift(random), shift(random), shift(random)));
      fast.find(a.at(), b.at());
      reference.find_by_reference(a.at(), b.at());
      ASSERT_EQ(fast.springs().size(), reference.springs().size());
      for (std::size_t s = 0; s < fast.springs().size(); ++s) {
        const Spring &f = fast.springs()[s], &r = reference.springs()[s];
        ASSERT_EQ(f.point, r.point);
        if (f.face == r.face) {
          EXPECT_LT((f.reach - r.reach).norm(), 1e-15);
        } else {
          EXPECT_NEAR(f.reach.norm(), r.reach.norm(), 2e-7);  // [m], for bodies of 0.1 m: single precision
          ++elsewhere;
        }
      }
      springs += fast.springs().size();
    }
    EXPECT_GT(springs, 200u);
    EXPECT_LE(elsewhere, springs / 500);
  };
  Pair pair;
  compare(pair.a, pair.b, {0.168, 0.01, -0.006}, 1.0, 1);
  compare(pair.a, pair.b, {0.168, 0.01, -0.006}, 1.0, 2);
  const Body box = shell(mesh::box_surface({0.1, 0.2, 0.05}, {6, 12, 3}));
  Body gear = shell(shapes::make("gear").skin);
  compare(box, gear, {0.08, 0, 0}, 1.0, 1);
  // Deep inside, the points of a packet are close together relative to their distance: bounds on clusters are
  // tight.
  const Body around = shell(bumpy_sphere(0.1, 16, 0.2));
  Body within = shell(bumpy_sphere(0.02, 8, 0.2));
  compare(around, within, {0.03, 0.01, -0.02}, 1.0, 1);
}

// A diverging integrator evaluates contact at positions beyond single precision, whose squares exceed double,
// and at NaN.
TEST(SkinContact, AbsurdPositionsDoNoHarm) {
  Pair pair;
  SkinContact contact(pair.a.skin, pair.b.skin, {.stiffness_pa_m = kStiffness});
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  for (const double size :
       {1e3, 1e8, 1e9, 1e10, 1e12, 1e15, 1e19, 1e38, 1e76, 1e155, 1e200, 1e308, HUGE_VAL, std::nan("")})
    for (const double near : {0.0, 0.01, 1e76, HUGE_VAL, std::nan("")})
      for (const bool one_node : {true, false}) {
        Body a = pair.a, b = pair.b;
        for (Body* body : {&a, &b})
          for (double& x : body->nodes.reshaped())
            if (!one_node) x *= size * normal(random);
        a.nodes(0, a.nodes.cols() / 2) *= size;
        contact.find(a.at(), b.at(), near);
        contact.follow(a.at(), b.at());
        Points fa = Points::Zero(3, a.nodes.cols()), fb = Points::Zero(3, b.nodes.cols());
        contact.add_force(fa.data(), fb.data());
        contact.quadrature_error();
      }
  // the next search is unaffected
  SkinContact fresh(pair.a.skin, pair.b.skin, {.stiffness_pa_m = kStiffness});
  contact.find(pair.a.at(), pair.b.at());
  fresh.find(pair.a.at(), pair.b.at());
  EXPECT_GT(fresh.energy(), 0.0);
  EXPECT_EQ(contact.energy(), fresh.energy());
}

TEST(SkinContactMemory, NothingIsAllocatedAfterConstruction) {
#if !PALPATE_CAN_COUNT
  GTEST_SKIP() << "a sanitizer brings its own malloc";
#else
  Pair pair;
  SkinContact contact(pair.a.skin, pair.b.skin, {.stiffness_pa_m = kStiffness});
  Points fa = Points::Zero(3, pair.a.nodes.cols()), fb = Points::Zero(3, pair.b.nodes.cols());
  for (int i = 0; i < 4; ++i) {
    pair.b.nodes.row(0).array() -= 0.003;
    const long before = malloc_calls;
    contact.find(pair.a.at(), pair.b.at());
    contact.add_force(fa.data(), fb.data());
    contact.follow(pair.a.at(), pair.b.at());
    EXPECT_EQ(malloc_calls - before, 0);
  }
  EXPECT_GT(contact.springs().size(), 100u);
#endif
}

TEST(SkinContact, RejectsAStiffnessThatIsNone) {
  const Skin skin = make_skin(mesh::sphere(1.0, 2));
  expect_message([&] { SkinContact(skin, skin, {.stiffness_pa_m = 0.0}); }, {"stiffness = 0", "positive"});
}
