#include <cairo.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "cli/contact_picture.h"
#include "cli/frames.h"
#include "cli/picture.h"
#include "cli/undelivered.h"
#include "contact/grid_proxies.h"
#include "loop/over_block.h"
#include "loop/small_scenes.h"
#include "palpate/core/counters.h"
#include "palpate/core/error.h"
#include "palpate/mesh/generators.h"
#include "palpate/store/model_file.h"
#include "temporary_folder.h"

// Pictures of a run: two soft blocks with skins, one pressed 1 mm into the other.

using namespace palpate;

namespace {

struct Png {
  int width = 0, height = 0;
  std::vector<std::array<int, 3>> pixels;
  std::array<int, 3> at(int x, int y) const {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
  }
  /// How many pixels of columns [x0, x1) satisfy it.
  template <class Is>
  int count(int x0, int x1, Is is) const {
    int n = 0;
    for (int y = 0; y < height; ++y)
      for (int x = x0; x < x1; ++x) n += is(at(x, y));
    return n;
  }
};

Png read_png(const std::filesystem::path& path) {
  Png out;
  cairo_surface_t* surface = cairo_image_surface_create_from_png(path.c_str());
  EXPECT_EQ(cairo_surface_status(surface), CAIRO_STATUS_SUCCESS) << path;
  out.width = cairo_image_surface_get_width(surface);
  out.height = cairo_image_surface_get_height(surface);
  const unsigned char* data = cairo_image_surface_get_data(surface);
  const int stride = cairo_image_surface_get_stride(surface);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      const unsigned char* p = data + y * stride + 4 * x;  // B, G, R on these machines
      out.pixels.push_back({p[2], p[1], p[0]});
    }
  cairo_surface_destroy(surface);
  return out;
}

const auto is_blue = [](std::array<int, 3> c) { return c[2] > c[0] + 60 && c[2] > c[1] + 25; };
const auto is_orange = [](std::array<int, 3> c) { return c[0] > c[2] + 70 && c[0] > c[1] + 25; };
const auto is_red = [](std::array<int, 3> c) { return c[0] > 130 && c[0] > 2 * c[1] && c[0] > 2 * c[2]; };
const auto is_greatest = [](std::array<int, 3> c) {  // viridis(1), unlit
  return std::abs(c[0] - 253) < 3 && std::abs(c[1] - 231) < 3 && std::abs(c[2] - 37) < 6;
};

class Pictures : public testing::Test {
 protected:
  TemporaryFolder folder_;

  /// @param proxies  of both skins
  scene::Description blocks(bool proxies, double depth = 1e-3) {
    LayeredModel model;
    model.name = "block";
    model.tets = mesh::box(Vec3(0.04, 0.04, 0.02), {4, 4, 2});
    model.skin = mesh::box_surface(Vec3(0.04, 0.04, 0.02), {24, 24, 12});
    model.embedding = mesh::embed(model.tets, model.skin.vertices);
    model.proxies = contact_tests::grid_proxies(model.skin, 2);
    const std::string path = (folder_ / "block.h5").string();
    store::write_model(path, {model, {}});
    scene::Description d = small_scenes::held_block();
    d.bodies[0].mesh = {};
    d.bodies[0].mesh.file = path;
    d.bodies[0].skin = true;
    d.bodies[0].proxies = proxies;
    SoftBodySpec upper = d.bodies[0];
    upper.position_m = Vec3(0.017, 0.011, 0.03 - depth);
    small_scenes::put_over_block(d, upper);
    return d;
  }

  static loop::RunResult run(loop::World& world, loop::Observer& observer) {
    world.contact->keep_views();
    loop::RunOptions options;
    options.observers = {&observer};
    return loop::run(world, options);
  }
};

}  // namespace

TEST_F(Pictures, ContactHasProxiesInOnePanelAndVerticesInTheOther) {
  const auto world = loop::assemble(blocks(true));
  cli::ContactSnapshot snapshot;
  ASSERT_TRUE(run(*world, snapshot).status.ok());
  cli::Undelivered missing;
  snapshot.save(*world, folder_.path().string(), missing);
  EXPECT_TRUE(missing.empty());
  const Png contact = read_png(folder_ / "contact.png");
  ASSERT_EQ(contact.width, 2 * contact.height);
  const int half = contact.width / 2;
  EXPECT_GT(contact.count(0, half, is_blue), 500);    // hulls of one side
  EXPECT_GT(contact.count(0, half, is_orange), 500);  // and of the other
  EXPECT_EQ(contact.count(0, half, is_red), 0);
  EXPECT_GT(contact.count(half, 2 * half, is_red), 500);  // colliding vertices
}

TEST_F(Pictures, WithoutProxiesNoHullsAreDrawn) {
  const auto world = loop::assemble(blocks(false));
  cli::ContactSnapshot snapshot;
  ASSERT_TRUE(run(*world, snapshot).status.ok());
  cli::Undelivered missing;
  snapshot.save(*world, folder_.path().string(), missing);
  EXPECT_TRUE(missing.empty());
  const Png contact = read_png(folder_ / "contact.png");
  EXPECT_EQ(contact.count(0, contact.width / 2, is_blue), 0);
  EXPECT_EQ(contact.count(0, contact.width / 2, is_orange), 0);
  EXPECT_GT(contact.count(contact.width / 2, contact.width, is_red), 500);
}

TEST_F(Pictures, APictureOfDisplacementHasNeitherHullsNorVertices) {
  const auto world = loop::assemble(blocks(true));
  cli::Snapshot snapshot(cli::Shade::kPenetration);
  ASSERT_TRUE(run(*world, snapshot).status.ok());
  snapshot.save(*world, (folder_ / "picture.png").string());
  const Png picture = read_png(folder_ / "picture.png");
  EXPECT_EQ(picture.count(0, picture.width, is_red), 0);
  EXPECT_EQ(picture.count(0, picture.width, is_orange), 0);
}

#ifdef PALPATE_HAS_TOOL
// The hand presses for a moment and goes back.
TEST_F(Pictures, APictureIsOfTheLargestForceInBothSchemes) {
  for (const char* scheme : {"partitioned", "monolithic"}) {
    scene::Description d = small_scenes::pressed_block(-1e-4);
    KeyframeSpec pressed = d.device->keyframes[0], back = pressed;
    pressed.time_s = 0.05;
    pressed.position_m.z() -= 0.004;
    back.time_s = 0.25;  // slowly, so that the coupling pulls less than the block pressed
    d.device->keyframes = {d.device->keyframes[0], pressed, back};
    d.duration_s = 0.25;
    d.exchange.scheme = scheme;
    const auto world = loop::assemble(d);
    cli::Snapshot snapshot(cli::Shade::kDisplacement);
    ASSERT_TRUE(run(*world, snapshot).status.ok());
    EXPECT_GT(snapshot.time(), 0.0) << scheme;
    EXPECT_LT(snapshot.time(), 0.12) << scheme;
  }
}
#endif

// Flat faces, pressed evenly: the whole field is as deep as it gets, so it has the colour of the maximum.
TEST_F(Pictures, TheDeepestPixelsHaveTheColourOfTheMaximum) {
  scene::Description d = blocks(true);
  d.duration_s = 0.01;  // one query, of what was not moved yet
  const auto world = loop::assemble(d);
  cli::ContactSnapshot snapshot;
  ASSERT_TRUE(run(*world, snapshot).status.ok());
  cli::Undelivered missing;
  snapshot.save(*world, folder_.path().string(), missing);
  const Png depth = read_png(folder_ / "depth.png");
  // 23 mm x 29 mm of the blocks' faces overlap
  const int greatest = depth.count(0, depth.width, is_greatest);
  EXPECT_GT(greatest, depth.width * depth.height / 3);
}

TEST_F(Pictures, NothingThatTouchesIsSaidToBeMissing) {
  scene::Description d = blocks(true, -5e-3);
  const auto world = loop::assemble(d);
  cli::ContactSnapshot snapshot;
  ASSERT_TRUE(run(*world, snapshot).status.ok());
  cli::Undelivered missing;
  snapshot.save(*world, folder_.path().string(), missing);
  EXPECT_FALSE(missing.empty());
  EXPECT_FALSE(std::filesystem::exists(folder_ / "contact.png"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "depth.png"));
}

TEST_F(Pictures, FramesShareCameraAndColours) {
  scene::Description d = blocks(false);
  d.duration_s = 0.05;
  d.gravity_m_s2 = Vec3(0, 0, 9.81);  // lifts the upper block off: it moves, the held face does not
  const auto world = loop::assemble(d);
  cli::Frames frames(*world, cli::Shade::kDisplacement, 0.0, d.duration_s);
  EXPECT_EQ(frames.between_s(), 0.01);
  ASSERT_TRUE(run(*world, frames).status.ok());
  EXPECT_EQ(frames.count(), 5);
  cli::Undelivered missing;
  const long before = counters::counter("render.picture");
  EXPECT_EQ(frames.save(*world, (folder_ / "frames").string(), true, missing), 5);
  EXPECT_EQ(counters::counter("render.picture"), before + 5);
  EXPECT_TRUE(missing.empty());
  const Png first = read_png(folder_ / "frames/0000.png"), last = read_png(folder_ / "frames/0004.png");
  EXPECT_EQ(first.width, last.width);
  EXPECT_EQ(first.height, last.height);
  // the picture's right edge holds the scale: its numbers are those of the whole run, in every frame
  int different_scale = 0, different = 0;
  for (int y = 0; y < 720; ++y)
    for (int x = 0; x < first.width; ++x) {
      if (first.at(x, y) == last.at(x, y)) continue;
      ++different;
      different_scale += x > first.width - 120;
    }
  EXPECT_GT(different, 2000);
  EXPECT_EQ(different_scale, 0);
  // the held face stands still in the picture, so its lowest corner does
  const auto lowest = [&](const Png& png) {
    for (int y = 719; y > 120; --y)
      for (int x = 0; x < png.width - 120; ++x)
        if (png.at(x, y)[0] < 150) return std::pair(x, y);
    return std::pair(-1, -1);
  };
  EXPECT_GT(lowest(first).second, 400);
  EXPECT_EQ(lowest(first), lowest(last));
  // what was not moved yet has the lowest colour
  EXPECT_EQ(first.count(0, first.width - 130, is_greatest), 0);
}

TEST_F(Pictures, FramesStandAtWholePeriodsOnly) {
  const auto world = loop::assemble(blocks(false));
  EXPECT_NEAR(cli::Frames(*world, cli::Shade::kDisplacement, 30.0, 0.1).between_s(), 0.03, 1e-15);
  EXPECT_NEAR(cli::Frames(*world, cli::Shade::kDisplacement, 100.0, 0.1).between_s(), 0.01, 1e-15);
  EXPECT_THROW(cli::Frames(*world, cli::Shade::kDisplacement, 200.0, 0.1), Error);
}

TEST_F(Pictures, AFrameThatCannotBeWrittenIsNamed) {
  const auto world = loop::assemble(blocks(false));
  cli::Frames frames(*world, cli::Shade::kDisplacement, 0.0, 0.04);
  ASSERT_TRUE(run(*world, frames).status.ok());
  cli::Undelivered missing;
  std::filesystem::create_directories(folder_ / "frames/0002.part");  // where its draft would be
  EXPECT_EQ(frames.save(*world, (folder_ / "frames").string(), true, missing), 2);
  EXPECT_FALSE(missing.empty());
  EXPECT_EQ(missing.close(0), 3);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "frames/0001.png"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "frames/0002.png"));
}
