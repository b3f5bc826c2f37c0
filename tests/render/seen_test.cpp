#include "render/seen.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "shapes.h"

using namespace palpate;
using render::Surface;
using render::View;

namespace {

Surface subject(const Vec3& centre, double radius = 1.0) {
  Surface ball = ball_surface(centre, radius, 24);
  ball.subject = true;
  return ball;
}

/// Part of the plane x = `at` with y below `edge`.
Surface wall(double at, double edge) {
  Surface out;
  out.points.resize(3, 4);
  out.points << at, at, at, at, -9, edge, edge, -9, -9, -9, 9, 9;
  out.faces.resize(3, 2);
  out.faces << 0, 0, 1, 2, 2, 3;
  return out;
}

Surface block(const Vec3& low, const Vec3& size) {
  Surface out = cube_surface();
  out.points = (size.asDiagonal() * out.points).colwise() + low;
  return out;
}

View along_x() {
  View view;
  view.azimuth_deg = view.elevation_deg = 0.0;  // the eye is at +x, y to its right
  return view;
}

View chosen(const render::Scene& scene, bool from_below = true) {
  render::ViewChoice choice;
  choice.add(scene);
  return choice.best(from_below);
}

bool is_usual(const View& view) {
  return view.azimuth_deg == View{}.azimuth_deg && view.elevation_deg == View{}.elevation_deg;
}

}  // namespace

// A disc cut by a line at distance h from its centre: the part beyond it is (acos h - h sqrt(1 - h^2)) / pi.
TEST(SeenShare, IsTheCircularSegmentBesideAWall) {
  for (const double h : {-0.8, -0.3, 0.0, 0.4, 0.9}) {
    const render::Scene scene{{subject(Vec3::Zero()), wall(2.0, h)}};
    const double expected = (std::acos(h) - h * std::sqrt(1.0 - h * h)) / std::numbers::pi;
    EXPECT_NEAR(render::visible_share(scene, along_x()), expected, 0.02) << h;
  }
}

TEST(SeenShare, IsWholeWhereNothingOpaqueStandsInFront) {
  EXPECT_EQ(render::visible_share({{subject(Vec3::Zero()), wall(-2.0, 9.0)}}, along_x()), 1.0);
  render::Scene glass{{subject(Vec3::Zero()), wall(2.0, 9.0)}};
  EXPECT_EQ(render::visible_share(glass, along_x()), 0.0);
  glass.surfaces[1].opacity = 0.9;
  EXPECT_EQ(render::visible_share(glass, along_x()), 1.0);
  EXPECT_EQ(render::visible_share({{wall(2.0, 9.0)}}, along_x()), 1.0) << "no subject";
  EXPECT_EQ(render::visible_share({}, along_x()), 1.0);
}

// A ball that sinks into a block: an eye to its side sees the part above.
TEST(SeenShare, IsWhatStandsOutOfABody) {
  const render::Scene scene{{subject(Vec3::Zero()), block(Vec3(-5, -5, -5), Vec3(10, 10, 5))}};
  EXPECT_NEAR(render::visible_share(scene, along_x()), 0.5, 0.02);
}

TEST(ViewChoice, TurnsToTheSideWhereTheSubjectIs) {
  // the default eye is at azimuth -60 degrees: the block hides objects at 120
  const Vec3 behind(-2.0 * std::cos(std::numbers::pi / 3), 2.0 * std::sin(std::numbers::pi / 3), 0.0);
  const render::Scene scene{{subject(behind, 0.3), block(Vec3::Constant(-1.5), Vec3::Constant(3.0))}};
  EXPECT_LT(render::visible_share(scene, View{}), 0.1);
  const View view = chosen(scene);
  EXPECT_FALSE(is_usual(view));
  EXPECT_GT(render::visible_share(scene, view), 0.95);
}

TEST(ViewChoice, StaysWhereEnoughIsSeenOrTurningDoesNotHelp) {
  const Surface body = block(Vec3::Constant(-1.5), Vec3::Constant(3.0));
  EXPECT_TRUE(is_usual(chosen({{subject(Vec3(0.0, -1.7, 0.0), 0.3), body}})));
  EXPECT_TRUE(is_usual(chosen({{subject(Vec3::Zero(), 0.3), body}}))) << "swallowed";
  // inside a body, visible only through a slit in its far side
  EXPECT_TRUE(is_usual(chosen({{subject(Vec3(0.0, 1.25, 0.0), 0.3), body}}))) << "little is seen anywhere";
  EXPECT_TRUE(is_usual(chosen({{body}}))) << "no subject";
  EXPECT_TRUE(is_usual(render::ViewChoice().best(true))) << "no instant";
}

TEST(ViewChoice, LooksFromBelowWhereNoGroundIs) {
  const render::Scene scene{{subject(Vec3(0.0, 0.0, -1.7), 0.3), block(Vec3(-4, -4, -1.5), Vec3(8, 8, 1.5))}};
  EXPECT_LT(chosen(scene).elevation_deg, 0.0);
  EXPECT_TRUE(is_usual(chosen(scene, false)));
}

// Two instants of a subject that moves around its body: the view in which it is visible in both, or most of
// them.
TEST(ViewChoice, CountsAllInstants) {
  const Surface body = block(Vec3::Constant(-1.5), Vec3::Constant(3.0));
  render::ViewChoice choice;
  const auto at = [](double azimuth_deg) {
    const double a = azimuth_deg * std::numbers::pi / 180.0;
    return Vec3(2.2 * std::cos(a), 2.2 * std::sin(a), 0.0);
  };
  for (const double azimuth : {75.0, 120.0, 165.0}) choice.add({{subject(at(azimuth), 0.3), body}});
  const View view = choice.best(true);
  for (const double azimuth : {75.0, 120.0, 165.0})
    EXPECT_GT(render::visible_share({{subject(at(azimuth), 0.3), body}}, view), 0.9) << azimuth;
}
