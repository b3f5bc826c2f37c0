#include <cairo.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "core/counters.h"
#include "render/scene.h"
#include "render/shapes.h"
#include "temporary_folder.h"

using namespace palpate;
using render::Picture;

namespace {

constexpr double kRadius = 0.04;
constexpr int kPixels = 400;
// The ball's radius in pixels under front_camera(1.25 kRadius): 400 / 2 / 1.25.
constexpr double kRadiusPixels = 160.0;

render::Options plain_options() {
  render::Options options;
  options.width = options.height = kPixels;
  options.camera = front_camera(1.25 * kRadius);
  options.lit = options.annotated = false;
  return options;
}

render::Scene ball_scene() {
  render::Scene scene;
  scene.surfaces.push_back(ball_surface(Vec3::Zero(), kRadius, 100));
  return scene;
}

void expect_colour(const Picture& picture, int x, int y, render::Rgb colour, double tolerance) {
  EXPECT_NEAR(picture.pixel(x, y)[0], 255.0 * colour.r, tolerance) << x << ", " << y;
  EXPECT_NEAR(picture.pixel(x, y)[1], 255.0 * colour.g, tolerance) << x << ", " << y;
  EXPECT_NEAR(picture.pixel(x, y)[2], 255.0 * colour.b, tolerance) << x << ", " << y;
}

double brightness(const Picture& picture, int x, int y) {
  return picture.pixel(x, y)[0] + picture.pixel(x, y)[1] + picture.pixel(x, y)[2];
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

TEST(Draw, ABallsSilhouetteIsACircleWithinAPixel) {
  const render::Options options = plain_options();
  const render::Scene scene = ball_scene();
  const Picture picture = render::draw(scene, options);
  int inside = 0, outside = 0;
  for (int y = 0; y < kPixels; ++y)
    for (int x = 0; x < kPixels; ++x) {
      const double distance = std::hypot(x + 0.5 - kPixels / 2, y + 0.5 - kPixels / 2);
      if (distance < kRadiusPixels - 1.0) {
        ++inside;
        ASSERT_NEAR(picture.pixel(x, y)[0], 255.0 * scene.surfaces[0].colour.r, 1.0) << x << ", " << y;
      } else if (distance > kRadiusPixels + 1.0) {
        ++outside;
        ASSERT_NEAR(picture.pixel(x, y)[0], 255.0 * options.background.r, 1.0) << x << ", " << y;
      }
    }
  EXPECT_GT(inside, 75000);
  EXPECT_GT(outside, 75000);
}

TEST(Draw, ColoursFollowTheValues) {
  render::Options options = plain_options();
  render::Scene scene = ball_scene();
  render::Surface& ball = scene.surfaces[0];
  scene.scale = {"x", "m", -kRadius, kRadius};
  ball.values = ball.points.row(0).transpose();  // the x coordinate
  const Picture picture = render::draw(scene, options);
  for (const int x : {60, 120, 200, 260, 330}) {
    const double value = (x + 0.5 - kPixels / 2) / kRadiusPixels;  // in units of the radius
    expect_colour(picture, x, kPixels / 2, render::ramp(0.5 + 0.5 * value), 2.5);
  }
  ball.values.setConstant(0.5 * kRadius);  // three quarters of the scale
  expect_colour(render::draw(scene, options), kPixels / 2, kPixels / 2, render::ramp(0.75), 1.0);
}

TEST(Draw, LightComesFromAboveAndTheLeft) {
  render::Options options = plain_options();
  options.lit = true;
  const Picture picture = render::draw(ball_scene(), options);
  const int c = kPixels / 2, d = 80;
  EXPECT_GT(brightness(picture, c - d, c - d), brightness(picture, c + d, c + d) + 30);
  EXPECT_GT(brightness(picture, c, c - d), brightness(picture, c, c + d) + 30);
  EXPECT_GT(brightness(picture, c, c), 150.0);  // lit
  expect_colour(picture, 2, 2, options.background, 1.0);
}

TEST(Draw, WhatIsNearerHides) {
  render::Scene scene = ball_scene();
  scene.surfaces.insert(scene.surfaces.begin(), ball_surface({0, -2 * kRadius, 0}, 0.3 * kRadius, 30));
  scene.surfaces[0].colour = {1, 0, 0};
  const Picture before = render::draw(scene, plain_options());
  expect_colour(before, kPixels / 2, kPixels / 2, {1, 0, 0}, 1.0);
  scene.surfaces[0].points.row(1).array() += 4 * kRadius;  // now behind
  expect_colour(render::draw(scene, plain_options()), kPixels / 2, kPixels / 2, scene.surfaces[1].colour,
                1.0);
}

TEST(Draw, OpacityBlendsOnlyTheNearestLayer) {
  render::Scene scene = ball_scene();
  scene.surfaces[0].opacity = 0.25;
  scene.surfaces[0].colour = {0, 0, 0};
  const render::Options options = plain_options();
  const render::Rgb b = options.background;
  // One layer of black at a quarter opacity, rather than the two layers of a ball.
  expect_colour(render::draw(scene, options), kPixels / 2, kPixels / 2,
                {0.75f * b.r, 0.75f * b.g, 0.75f * b.b}, 1.5);
}

TEST(Draw, TheGroundTakesAShadowAndIsUnseenFromBelow) {
  render::Scene scene = ball_scene();
  render::Options options;
  options.width = options.height = kPixels;
  options.annotated = false;
  options.view.elevation_deg = 40.0;
  const Picture bare = render::draw(scene, options);
  scene.ground = render::Ground{-kRadius, 0.0};
  const Picture grounded = render::draw(scene, options);
  double darkest_change = 0.0;
  for (int y = 0; y < kPixels; ++y)
    for (int x = 0; x < kPixels; ++x)
      darkest_change = std::max(darkest_change, brightness(bare, x, y) - brightness(grounded, x, y));
  EXPECT_GT(darkest_change, 90.0);  // the shadow: at least 12 % of white
  options.view.elevation_deg = -40.0;
  scene.ground.reset();
  const Picture from_below = render::draw(scene, options);
  scene.ground = render::Ground{-kRadius, 0.0};
  EXPECT_EQ(render::draw(scene, options).rgba, from_below.rgba);
}

TEST(Draw, IsTheSameTwiceToTheByteOnDisk) {
  render::Scene scene = ball_scene();
  scene.surfaces[0].values = scene.surfaces[0].points.row(2).transpose();
  scene.scale = {"height", "m"};
  scene.title = "a ball";
  scene.ground = render::Ground{-kRadius, 0.0};
  render::Options options;
  options.width = 480;
  options.height = 360;
  const TemporaryFolder folder;
  const long before = counters::counter("render.picture");
  for (const char* name : {"one.png", "two.png"})
    render::save_png(render::draw(scene, options), folder / name);
  EXPECT_EQ(counters::counter("render.picture"), before + 2);
  EXPECT_EQ(bytes_of(folder / "one.png"), bytes_of(folder / "two.png"));

  cairo_surface_t* read = cairo_image_surface_create_from_png((folder / "one.png").c_str());
  ASSERT_EQ(cairo_surface_status(read), CAIRO_STATUS_SUCCESS);
  EXPECT_EQ(cairo_image_surface_get_width(read), 480);
  EXPECT_EQ(cairo_image_surface_get_height(read), 360);
  cairo_surface_destroy(read);
}

TEST(Draw, FramesFarFromTheOriginWithoutLosingPrecision) {
  // Floats at 1 km resolve 0.06 mm: the ball's 40 mm would appear rough if positions were not relative to the
  // scene.
  const render::Options options = [] {
    render::Options o;
    o.width = o.height = kPixels;
    o.lit = o.annotated = false;
    return o;
  }();
  const Picture here = render::draw(ball_scene(), options);
  render::Scene far = ball_scene();
  far.surfaces[0].points.colwise() += Vec3(1000, -2000, 500);
  const Picture there = render::draw(far, options);
  int different = 0;
  for (std::size_t i = 0; i < here.rgba.size(); ++i) different += std::abs(here.rgba[i] - there.rgba[i]) > 8;
  EXPECT_LT(different, 40);
}

// The farther of two transparent panes is visible, in any order of surfaces.
TEST(Draw, TransparentSurfacesBlendFromBehind) {
  render::Scene scene;
  for (const double y : {-2.0, 2.0}) {
    scene.surfaces.push_back(ball_surface({0, y * kRadius, 0}, 0.5 * kRadius, 30));
    scene.surfaces.back().opacity = 0.5;
    scene.surfaces.back().colour = y < 0 ? render::Rgb{1, 0, 0} : render::Rgb{0, 0, 1};
  }
  const render::Options options = plain_options();
  const render::Rgb b = options.background;
  const Picture picture = render::draw(scene, options);
  expect_colour(picture, kPixels / 2, kPixels / 2, {0.5f + 0.25f * b.r, 0.25f * b.g, 0.25f + 0.25f * b.b},
                2.0);
  std::swap(scene.surfaces[0], scene.surfaces[1]);
  EXPECT_EQ(render::draw(scene, options).rgba, picture.rgba);
}

// Frames of one movie: the same points define the camera, so that an object at rest has the same pixels.
TEST(Draw, AGivenFrameHoldsTheCameraStill) {
  render::Options options = plain_options();
  options.camera.reset();
  render::Scene scene = ball_scene();
  scene.surfaces.push_back(ball_surface({3 * kRadius, 0, 0}, 0.2 * kRadius, 20));
  const Points all = scene.surfaces[0].points;
  options.frame.resize(3, all.cols() + 1);
  options.frame << all, Vec3(6 * kRadius, 0, 0);
  const Picture before = render::draw(scene, options);
  scene.surfaces[1].points.row(0).array() += 2 * kRadius;
  const Picture after = render::draw(scene, options);
  options.frame = Points(3, 0);
  const Picture reframed = render::draw(scene, options);
  const auto left_edge = [&](const Picture& picture) {  // left edge of the large ball
    for (int x = 0; x < kPixels; ++x)
      for (int y = 0; y < kPixels; ++y)
        if (picture.pixel(x, y)[0] < 200) return x;
    return -1;
  };
  EXPECT_EQ(left_edge(after), left_edge(before));
  EXPECT_NE(before.rgba, after.rgba);
  EXPECT_NE(reframed.rgba, after.rgba);
}

TEST(Draw, ABodyAtRestHasOneColourAndOneNumber) {
  render::Scene scene = ball_scene();
  scene.surfaces[0].values = VecX::LinSpaced(scene.surfaces[0].points.cols(), 0.0, 2.5e-17);
  scene.scale = {"displacement", "m"};
  scene.scale.resolution = 1e-10;
  const Picture picture = render::draw(scene, plain_options());
  for (const int x : {100, 200, 300}) expect_colour(picture, x, kPixels / 2, render::ramp(0.0), 1.0);
}
