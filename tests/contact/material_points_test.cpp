// Material points of surfaces against exact shapes: their spacing, the quadrature error and its bound, and
// queries that do not depend on earlier ones.
#include <numbers>

#include "messages.h"
#include "palpate/contact/obstacle.h"
#include "surfaces.h"

using namespace contact_tests;

namespace {

constexpr double kRadius = 0.05, kDepth = kRadius / 8.0;
constexpr contact::CharacteristicLengths kHalfSpace{HUGE_VAL, HUGE_VAL, 0.0};
constexpr contact::CharacteristicLengths kBall{2.0 * kRadius, kRadius, 0.0};

/// Contact with the block's top, at height 0; its points are created once.
struct OnBlock {
  TriMesh rest;
  SurfaceWorld world{rest};
  contact::MaterialPoints points;
  std::unique_ptr<contact::SampleSource> source;

  explicit OnBlock(double spacing, int finer = 1)
      : rest(flat_block(finer)),
        points(contact::material_points(world.surface, rest.vertices, {}, spacing)) {}
  void place(const Vec3& ball, double turn) {
    TriMesh mesh = rest;
    for (auto x : mesh.vertices.colwise())
      x = Eigen::AngleAxisd(turn, Vec3::UnitZ()) * Vec3(x - Vec3(0, 0, 0.25));
    world.state.q().tail(mesh.vertices.size()) = mesh.vertices.reshaped();
    source = contact::make_sphere_source(points, 0, contact::fixed_frame(), ball, kRadius, 0.01);
  }
  Vec3 force() {
    std::vector<contact::ContactSample> samples;
    source->query(world.state.view(), samples);
    Vec3 sum = Vec3::Zero();
    for (const auto& s : samples) sum += s.area * std::max(0.0, -s.gap) * s.normal;
    return sum;
  }
};

/// Integral of depth times normal over the circle that a ball presses into a plane, along z.
double exact_force() {
  const double z = kRadius - kDepth, a2 = kRadius * kRadius - z * z;
  constexpr int n = 200000;
  double sum = 0.0;
  for (int i = 0; i < n; ++i) {
    const double r2 = a2 * (i + 0.5) / n, distance = std::sqrt(r2 + z * z);
    sum += (kRadius - distance) * z / distance * std::numbers::pi * a2 / n;
  }
  return sum;
}

struct Errors {
  double standard = 0.0;  ///< standard deviation, relative
  int bounded = 0;        ///< cases within the source's error bound, out of 100
};
Errors errors_at(double spacing) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> place(-0.3, 0.3), turn(0.0, 2.0 * std::numbers::pi);
  const Vec3 exact(0, 0, -exact_force());
  Errors out;
  OnBlock on(spacing, 2);
  double squares = 0.0;
  for (int i = 0; i < 100; ++i) {
    const Vec3 ball(place(random), place(random), kRadius - kDepth);
    on.place(ball, turn(random));
    const double error = (on.force() - exact).norm() / exact.norm();
    squares += error * error;
    out.bounded += error <= on.source->report().sum_error->last_relative();
  }
  out.standard = std::sqrt(squares / 100.0);
  return out;
}

}  // namespace

// A flat skin and a ball of known curvature: the remaining error is of second order, and no larger than
// requested.
TEST(MaterialPoints, ErrByWhatWasAskedFor) {
  for (const double requested : {3e-2, 1e-2, 3e-3}) {
    const Errors errors = errors_at(contact::point_spacing(kHalfSpace, kBall, requested));
    EXPECT_LT(errors.standard, requested);
    EXPECT_GT(errors.standard, 0.3 * requested) << "more points than that takes";
    EXPECT_GE(errors.bounded, 95);
  }
}

// The spacing follows from dimensional analysis, and the error from the square of the spacing: a hundredth of
// the error requires ten times finer points. A surface whose curvature the linear gaps do not include
// requires R/2 sqrt(1e-2/(0.036 + 1/2)); a plane requires no points.
TEST(MaterialPoints, SpacingFollowsRadiiAndError) {
  const contact::CharacteristicLengths ball{0.1, 0.05, 0.0}, large{0.2, 0.1, 0.0}, faceted{0.1, 0.05, 20.0};
  const double one = contact::point_spacing(kHalfSpace, ball, 1e-2);
  EXPECT_NEAR(one, 0.025 * std::sqrt(1e-2 / 0.036), 1e-15);
  EXPECT_NEAR(contact::point_spacing(large, ball, 1e-2), one, 1e-15);
  EXPECT_NEAR(contact::point_spacing(ball, large, 1e-2), 2.0 * one, 1e-15);
  EXPECT_NEAR(contact::point_spacing(kHalfSpace, ball, 1e-4), 0.1 * one, 1e-12);
  EXPECT_EQ(contact::point_spacing(ball, kHalfSpace, 1e-4), HUGE_VAL);
  EXPECT_NEAR(contact::point_spacing(kHalfSpace, faceted, 1e-2), 0.025 * std::sqrt(1e-2 / 0.536), 1e-12);
  expectations::expect_contains(expectations::message_of([&] { contact::point_spacing(ball, ball, 0.0); }),
                                "quadrature_error = 0 must be positive");
}

TEST(MaterialPoints, AreaIsTheSurfacesAndPointsLieOnIt) {
  const SkinWorld skin;
  const TriMesh rest = mesh::sphere(1.0, 12);
  const contact::MaterialPoints soft = contact::material_points(skin.surface, rest.vertices, skin.ball, 0.1),
                                rigid = contact::material_points(
                                    contact::FrameSurface{rest, 4, contact::fixed_frame()}, 0.1);
  double area = 0.0;
  for (Eigen::Index f = 0; f < rest.faces.cols(); ++f)
    area += 0.5 * Vec3(rest.vertices.col(rest.faces(1, f)) - rest.vertices.col(rest.faces(0, f)))
                      .cross(Vec3(rest.vertices.col(rest.faces(2, f)) - rest.vertices.col(rest.faces(0, f))))
                      .norm();
  ASSERT_EQ(soft.at.size(), rigid.at.size());
  ASSERT_GT(soft.at.size(), static_cast<std::size_t>(rest.faces.cols()));
  for (const contact::MaterialPoints& points : {soft, rigid}) {
    EXPECT_NEAR(points.area.sum(), area, 1e-12 * area);
    EXPECT_EQ(points.triangles.maxCoeff() + 1, static_cast<int>(points.at.size()));
    EXPECT_EQ(points.edges2.size(), points.triangles.cols());
  }
  for (std::size_t i = 0; i < soft.at.size(); ++i) {
    Vec3 x = Vec3::Zero();
    for (std::size_t k = 0; k < 4; ++k) x += soft.at[i].weight[k] * skin.ball.nodes.col(soft.at[i].node[k]);
    EXPECT_LT((x - rigid.at[i].offset).norm(), 1e-13);
    EXPECT_EQ(rigid.at[i].frame, 4);
  }
}

// The force on a ball by its own points is k pi R depth^2 at any depth. The block's points on a sphere
// smaller than its triangles give the same force as the block's exact surface, where its vertices give none.
TEST(MaterialPoints, ABallFeelsItsOwnSurface) {
  const dynamics::State state;
  for (const double depth : {1e-6, 1e-3, 0.04}) {
    const contact::FrameBall ball{kRadius, Vec3::Zero(), 0,
                                  contact::fixed_frame({Quat::Identity(), Vec3(0.4, -2.0, kRadius - depth)}),
                                  true};
    const auto source =
        contact::make_plane_source(ball, 1, contact::fixed_frame(), Vec3::Zero(), Vec3::UnitZ(), 0.01);
    std::vector<contact::ContactSample> samples;
    source->query(state.view(), samples);
    double sum = 0.0;
    for (const auto& s : samples) sum += s.area * std::max(0.0, -s.gap);
    EXPECT_NEAR(sum / (std::numbers::pi * kRadius * depth * depth), 1.0, depth < 1e-5 ? 1e-6 : 1e-12)
        << depth;
  }
}

TEST(MaterialPoints, SeeWhatIsSmallerThanATriangle) {
  const Vec3 between(0.1, 0.03, kRadius - kDepth);
  OnBlock on(contact::point_spacing(kHalfSpace, kBall, 1e-2));
  on.place(between, 0.0);
  EXPECT_NEAR(on.force().norm() / exact_force(), 1.0, 0.03);
  contact::NodeSurface surface = on.world.surface;
  const auto vertices =
      contact::make_sphere_source(std::move(surface), 0, contact::fixed_frame(), between, kRadius, 0.01);
  std::vector<contact::ContactSample> samples;
  vertices->query(on.world.state.view(), samples);
  for (const auto& s : samples) EXPECT_GT(s.gap, 0.0);
}

// Gaps to a plane are linear on the box's triangles, two per side, so that the quadrature is exact: corner
// down, edge down and flat, against a subdivided box and, flat, against the area of its face and the
// contribution of its sides.
TEST(MaterialPoints, ABoxOnAPlaneIsExact) {
  const dynamics::State state;
  const Vec3 size(0.03, 0.02, 0.02);
  constexpr double kDown = 2e-3;
  for (const Vec3& turn : {Vec3(0.4, 0.3, 0.2), Vec3(0.6, 0.0, 0.0), Vec3(0.5, -0.7, 0.0), Vec3(0, 0, 0.3)}) {
    const auto force = [&](const std::array<int, 3>& cells, double spacing) {
      const TriMesh box = mesh::box_surface(size, cells);
      const Quat rotation = quaternion_of(turn);
      const double lowest = (rotation.toRotationMatrix() * box.vertices).row(2).minCoeff();
      const Pose pose{rotation, Vec3(0, 0, -kDown - lowest)};
      const auto source = contact::make_plane_source(
          contact::material_points(contact::FrameSurface{box, 0, contact::fixed_frame(pose)}, spacing), 1,
          contact::fixed_frame(), Vec3::Zero(), Vec3::UnitZ(), 0.01);
      std::vector<contact::ContactSample> samples;
      source->query(state.view(), samples);
      double sum = 0.0;
      for (const auto& s : samples) sum += s.area * std::max(0.0, -s.gap);
      EXPECT_EQ(source->report().sum_error->last_relative(), 0.0) << turn.transpose();
      return sum;
    };
    const double coarse = force({1, 1, 1}, HUGE_VAL);
    EXPECT_NEAR(coarse / force({60, 40, 40}, HUGE_VAL), 1.0, 1e-12) << turn.transpose();
    EXPECT_NEAR(coarse / force({1, 1, 1}, 0.003), 1.0, 1e-12) << turn.transpose();
    if (turn.head<2>().isZero()) {
      EXPECT_NEAR(coarse, size.x() * size.y() * kDown + (size.x() + size.y()) * kDown * kDown, 1e-18);
    }
  }
}

namespace {

class Placed final : public contact::MovingFrame {
 public:
  Pose at;
  Twist going;
  Pose pose(const dynamics::StateView&) const override { return at; }
  Twist twist(const dynamics::StateView&) const override { return going; }
};

}  // namespace

// A source that has followed a ball rolling, turning and jumping returns the same samples as a new one,
// whichever points it skipped meanwhile.
TEST(MaterialPoints, AQueryIsTheSameWhateverWasAskedBefore) {
  const TriMesh rest = flat_block();
  SurfaceWorld world{flat_block()};
  const contact::MaterialPoints points = contact::material_points(world.surface, rest.vertices, {}, 0.03);
  const auto frame = std::make_shared<Placed>();
  constexpr double kLookAhead = 0.01, kGap = 0.005;
  const Vec3 centre(0.02, 0.0, 0.01);  // in the frame: it moves as the frame turns
  const auto ball = [&] {
    return contact::make_sphere_source(points, 0, frame, centre, kRadius, kGap, kLookAhead);
  };
  const auto used = ball();
  std::mt19937 random(7);
  int touched = 0;
  for (int i = 0; i < 200; ++i) {
    const double step = i % 20 == 0 ? 0.4 : 0.01;
    frame->at.translation += step * Vec3(uniform(random), uniform(random), 0.3 * uniform(random));
    frame->at.translation =
        frame->at.translation.cwiseMax(Vec3(-0.5, -0.5, 0.25)).cwiseMin(Vec3(0.5, 0.5, 0.4));
    frame->at.rotation = quaternion_of(Vec3(0.1 * i, 0.0, 0.3 * uniform(random)));
    frame->going = {Vec3(uniform(random), 0, 0), 2.0 * Vec3(uniform(random), 0.0, uniform(random))};
    world.state.q().tail(rest.vertices.size()) =
        (rest.vertices.colwise() + 0.01 * Vec3(uniform(random), 0, uniform(random))).reshaped();
    std::vector<contact::ContactSample> of_used, of_fresh;
    const auto fresh = ball();
    used->query(world.state.view(), of_used);
    fresh->query(world.state.view(), of_fresh);
    ASSERT_EQ(of_used.size(), of_fresh.size()) << i;
    for (std::size_t s = 0; s < of_used.size(); ++s) {
      EXPECT_EQ(of_used[s].gap, of_fresh[s].gap);
      EXPECT_EQ(of_used[s].a.node, of_fresh[s].a.node);
    }
    EXPECT_EQ(std::min(used->report().safe_time, kLookAhead), std::min(fresh->report().safe_time, kLookAhead))
        << i;
    touched += of_used.size() > 3;
  }
  EXPECT_GT(touched, 30);
}

// Straight down without rotation, so that only the translation uses up a clearance.
TEST(MaterialPoints, AJumpStraightDownMissesNothing) {
  const TriMesh rest = flat_block();
  const SurfaceWorld world{flat_block()};
  const auto frame = std::make_shared<Placed>();
  const auto ball = [&] {
    return contact::make_sphere_source(contact::material_points(world.surface, rest.vertices, {}, 0.03), 0,
                                       frame, Vec3::Zero(), kRadius, 1e-4, 0.01);
  };
  const auto source = ball();
  for (const double from : {0.05, 0.1, 0.5})
    for (const double depth : {1e-6, 1e-3}) {
      std::vector<contact::ContactSample> samples;
      frame->at.translation = Vec3(0, 0, 0.25 + kRadius + from);  // above a vertex
      source->query(world.state.view(), samples);
      EXPECT_TRUE(samples.empty());
      frame->at.translation.z() -= from + depth;
      source->query(world.state.view(), samples);
      ASSERT_FALSE(samples.empty()) << from;
      const auto fresh = ball();
      std::vector<contact::ContactSample> of_fresh;
      fresh->query(world.state.view(), of_fresh);
      double deepest = 0.0;
      for (const auto& s : of_fresh) deepest = std::min(deepest, s.gap);
      EXPECT_LT(deepest, 0.0);
      double found = 0.0;
      for (const auto& s : samples) found = std::min(found, s.gap);
      EXPECT_EQ(found, deepest);
    }
}

TEST(MaterialPoints, SumsErrorsLargestOnesGoOn) {
  contact::SumError kept;
  kept.take({4.0, 0.2, 0.5});
  kept.take({1.0, 0.4, 0.1});
  EXPECT_EQ(kept.last_relative(), 0.4);
  EXPECT_EQ(kept.largest(), 0.1);
  EXPECT_EQ(kept.largest_share(), 0.125);
  Archive keeps;
  kept.archive(keeps);
  Archive gives(keeps.values(), "kept");
  contact::SumError on;
  on.archive(gives);
  gives.check_all_restored();
  on.take({2.0, 0.1, 0.1});
  EXPECT_EQ(on.largest(), 0.1);
  EXPECT_EQ(on.largest_share(), 0.125);
  on.take({});
  EXPECT_EQ(on.last_relative(), 0.0) << "nothing overlaps, nothing errs";
}

TEST(MaterialPoints, RefuseASurfaceThatIsOpen) {
  TriMesh open = flat_block();
  open.faces.conservativeResize(3, open.faces.cols() - 1);
  expectations::expect_contains(
      expectations::message_of([&] {
        contact::material_points(contact::FrameSurface{open, 0, contact::fixed_frame()}, 0.1);
      }),
      "closed");
}
