#include <cairo.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "contact/grid_proxies.h"
#include "core/counters.h"
#include "core/missing_outputs.h"
#include "loop/over_block.h"
#include "loop/small_scenes.h"
#include "palpate/core/error.h"
#include "palpate/core/named_enum.h"
#include "palpate/mesh/generators.h"
#include "session/frame_folder.h"
#include "session/movie_file.h"
#include "session/movie_frames.h"
#include "session/peak_contact_picture.h"
#include "session/peak_force_picture.h"
#include "store/model_file.h"
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
  /// Number of pixels in columns [x0, x1) for which `is` holds.
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
      const unsigned char* p = data + y * stride + 4 * x;  // B, G, R on little-endian machines
      out.pixels.push_back({p[2], p[1], p[0]});
    }
  cairo_surface_destroy(surface);
  return out;
}

const auto is_blue = [](std::array<int, 3> c) { return c[2] > c[0] + 60 && c[2] > c[1] + 25; };
const auto is_orange = [](std::array<int, 3> c) { return c[0] > c[2] + 70 && c[0] > c[1] + 25; };
const auto is_cyan = [](std::array<int, 3> c) {  // colliding vertices, but not the blue hulls
  return c[2] > c[0] + 80 && c[1] > c[0] + 80 && c[1] > c[2] - 50;
};
const auto is_greatest = [](std::array<int, 3> c) {  // ramp(1), unlit
  return std::abs(c[0] - 0x73) < 3 && std::abs(c[1] - 0x14) < 3 && std::abs(c[2] - 0x43) < 3;
};

class Pictures : public testing::Test {
 protected:
  TemporaryFolder folder_;

  /// @param proxies  whether both skins get contact proxies
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
    d.contacts[0].method = "image";
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
  session::PeakContactPicture peak;
  ASSERT_TRUE(run(*world, peak).status.ok());
  MissingOutputs missing;
  peak.save(*world, folder_.path().string(), missing);
  EXPECT_TRUE(missing.empty());
  const Png contact = read_png(folder_ / "contact.png");
  ASSERT_EQ(contact.width, 2 * contact.height);
  const int half = contact.width / 2;
  EXPECT_GT(contact.count(0, half, is_blue), 500);    // hulls of the first side
  EXPECT_GT(contact.count(0, half, is_orange), 500);  // hulls of the second side
  EXPECT_EQ(contact.count(0, half, is_cyan), 0);
  EXPECT_GT(contact.count(half, 2 * half, is_cyan), 500);  // colliding vertices
}

TEST_F(Pictures, WithoutProxiesNoHullsAreDrawn) {
  const auto world = loop::assemble(blocks(false));
  session::PeakContactPicture peak;
  ASSERT_TRUE(run(*world, peak).status.ok());
  MissingOutputs missing;
  peak.save(*world, folder_.path().string(), missing);
  EXPECT_TRUE(missing.empty());
  const Png contact = read_png(folder_ / "contact.png");
  EXPECT_EQ(contact.count(0, contact.width / 2, is_blue), 0);
  EXPECT_EQ(contact.count(0, contact.width / 2, is_orange), 0);
  EXPECT_GT(contact.count(contact.width / 2, contact.width, is_cyan), 500);
}

TEST_F(Pictures, APictureOfDisplacementHasNeitherHullsNorVertices) {
  const auto world = loop::assemble(blocks(true));
  session::PeakForcePicture peak(session::Shade::kPenetration);
  ASSERT_TRUE(run(*world, peak).status.ok());
  peak.save(*world, (folder_ / "picture.png").string());
  const Png picture = read_png(folder_ / "picture.png");
  EXPECT_EQ(picture.count(0, picture.width, is_cyan), 0);
  EXPECT_EQ(picture.count(0, picture.width, is_blue), 0);
}

#ifdef PALPATE_HAS_TOOL
// The picture shows the largest force of a hand that presses briefly and retreats, in both schemes.
TEST_F(Pictures, APictureIsOfTheLargestForceInBothSchemes) {
  for (const char* scheme : {"partitioned", "monolithic"}) {
    scene::Description d = small_scenes::pressed_block(-1e-4);
    KeyframeSpec pressed = d.device->keyframes[0], back = pressed;
    pressed.time_s = 0.05;
    pressed.position_m.z() -= 0.004;
    back.time_s = 0.25;  // slow enough for the coupling to pull less than the block pressed
    d.device->keyframes = {d.device->keyframes[0], pressed, back};
    d.duration_s = 0.25;
    d.exchange.scheme = *value_named<scene::ExchangeScheme>(scheme);
    const auto world = loop::assemble(d);
    session::PeakForcePicture peak(session::Shade::kDisplacement);
    ASSERT_TRUE(run(*world, peak).status.ok());
    EXPECT_GT(peak.time(), 0.0) << scheme;
    EXPECT_LT(peak.time(), 0.12) << scheme;
  }
}
#endif

// Flat faces under uniform pressure: the whole field has the maximum depth, and so the colour of the maximum.
TEST_F(Pictures, TheDeepestPixelsHaveTheColourOfTheMaximum) {
  scene::Description d = blocks(true);
  d.duration_s = 0.01;  // one contact query, of the initial state
  const auto world = loop::assemble(d);
  session::PeakContactPicture peak;
  ASSERT_TRUE(run(*world, peak).status.ok());
  MissingOutputs missing;
  peak.save(*world, folder_.path().string(), missing);
  const Png depth = read_png(folder_ / "depth.png");
  // 23 mm x 29 mm of the blocks' faces overlap
  const int greatest = depth.count(0, depth.width, is_greatest);
  EXPECT_GT(greatest, depth.width * depth.height / 3);
}

TEST_F(Pictures, NothingThatTouchesIsSaidToBeMissing) {
  scene::Description d = blocks(true, -5e-3);
  const auto world = loop::assemble(d);
  session::PeakContactPicture peak;
  ASSERT_TRUE(run(*world, peak).status.ok());
  MissingOutputs missing;
  peak.save(*world, folder_.path().string(), missing);
  EXPECT_FALSE(missing.empty());
  EXPECT_FALSE(std::filesystem::exists(folder_ / "contact.png"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "depth.png"));
}

TEST_F(Pictures, FramesShareCameraAndColours) {
  scene::Description d = blocks(false);
  d.duration_s = 0.05;
  d.gravity_m_s2 = Vec3(0, 0, 9.81);  // lifts the upper block off: it moves, the held face does not
  const auto world = loop::assemble(d);
  const double between_s = session::between_frames(d, 0.0);
  EXPECT_EQ(between_s, 0.01);
  session::MovieFrames frames(*world, folder_.path().string(), session::Shade::kDisplacement, between_s,
                              d.duration_s);
  ASSERT_TRUE(run(*world, frames).status.ok());
  EXPECT_EQ(frames.count(), 5);
  MissingOutputs missing;
  const long before = counters::counter("render.picture");
  const auto sink = session::make_frame_folder((folder_ / "frames").string());
  frames.save(*world, {sink.get()}, {}, missing);
  EXPECT_EQ(sink->written(), 5);
  EXPECT_EQ(counters::counter("render.picture"), before + 5);
  EXPECT_TRUE(missing.empty());
  const Png first = read_png(folder_ / "frames/0000.png"), last = read_png(folder_ / "frames/0004.png");
  EXPECT_EQ(first.width, last.width);
  EXPECT_EQ(first.height, last.height);
  // the picture's right edge shows the scale: its numbers cover the whole run and are equal in every frame
  int different_scale = 0, different = 0;
  for (int y = 0; y < 720; ++y)
    for (int x = 0; x < first.width; ++x) {
      if (first.at(x, y) == last.at(x, y)) continue;
      ++different;
      different_scale += x > first.width - 120;
    }
  EXPECT_GT(different, 2000);
  EXPECT_EQ(different_scale, 0);
  // the held face does not move in the picture, and neither does its lowest corner
  const auto lowest = [&](const Png& png) {
    for (int y = 719; y > 120; --y)
      for (int x = 0; x < png.width - 120; ++x)
        if (png.at(x, y)[0] < 200) return std::pair(x, y);
    return std::pair(-1, -1);
  };
  EXPECT_GT(lowest(first).second, 400);
  EXPECT_EQ(lowest(first), lowest(last));
  // the initial state has the lowest colour everywhere
  EXPECT_EQ(first.count(0, first.width - 130, is_greatest), 0);
}

TEST_F(Pictures, FramesStandAtWholePeriodsOnly) {
  const scene::Description d = blocks(false);  // periods of 10 ms
  EXPECT_NEAR(session::between_frames(d, 30.0), 0.03, 1e-15);
  EXPECT_NEAR(session::between_frames(d, 100.0), 0.01, 1e-15);
  EXPECT_THROW(session::between_frames(d, 200.0), Error);
}

TEST_F(Pictures, MoviesAreAsLongAsTheRunOrSlower) {
  const scene::Description d = blocks(false);  // periods of 10 ms
  EXPECT_NEAR(session::between_movie_frames(d, 0.0, 1.0), 0.04, 1e-15);
  EXPECT_NEAR(session::between_movie_frames(d, 0.0, 2.0), 0.02, 1e-15);
  EXPECT_NEAR(session::between_movie_frames(d, 10.0, 5.0), 0.02, 1e-15);
  EXPECT_NEAR(session::between_movie_frames(d, 0.0, 0.5), 0.08, 1e-15);
  EXPECT_NEAR(session::between_movie_frames(d, 0.0, 100.0), 0.01, 1e-15);  // limited by the number of periods
  EXPECT_THROW(session::between_movie_frames(d, 25.0, 100.0), Error);      // more frames than periods
}

TEST_F(Pictures, SizesAreEvenNumbersOfPixels) {
  EXPECT_EQ(session::frame_size("640x482").width, 640);
  EXPECT_EQ(session::frame_size("640x482").height, 482);
  for (const char* text : {"", "640", "640x", "x480", "640x480x", "640 x 480", "640x481", "639x480", "64x480",
                           "640x9000", "-640x480", "99999999999x480", "a"})
    EXPECT_THROW(session::frame_size(text), Error) << text;
}

// In real time, bodies that fell behind are held: frames at times without a state repeat the last state.
TEST_F(Pictures, FramesKeepTheirTimeWhereBodiesStandStill) {
  const scene::Description d = blocks(false);
  const auto world = loop::assemble(d);
  session::MovieFrames frames(*world, folder_.path().string(), session::Shade::kDisplacement, 0.02, 0.2,
                              {240, 218});
  for (const double t : {0.0, 0.01, 0.02, 0.09, 0.10, 0.2}) frames.period(*world, t);
  EXPECT_EQ(frames.count(), 10);  // states at 0, 20, 90 (for 80) and 100 ms; the end of the run adds none
  MissingOutputs missing;
  const long before = counters::counter("render.picture");
  const auto sink = session::make_frame_folder((folder_ / "frames").string());
  frames.save(*world, {sink.get()}, {}, missing);
  EXPECT_EQ(sink->written(), 10);
  EXPECT_EQ(counters::counter("render.picture"), before + 4);
  EXPECT_TRUE(missing.empty());
}

TEST_F(Pictures, InstantsComeBackFromDiskBitForBit) {
  session::WorldSnapshot first;
  first.time = 0.1;
  first.nodes = {Points::Random(3, 7), Points::Random(3, 2)};
  first.stress = {VecX::Random(7), VecX::Random(2)};
  first.depths = {{{3, 0.5f}, {5, 0.25f}}, {}};
  first.bones = {Pose{Quat(0.5, 0.5, 0.5, 0.5), Vec3(1, 2, 3)}};
  first.tools = {{Quat(0.0, 0.6, 0.8, 0.0), Vec3(4, 5, 6)}};
  session::WorldSnapshot second;
  second.time = 0.2;
  second.handle = Pose{Quat(0.6, 0.0, 0.0, 0.8), Vec3(7, 8, 9)};
  session::SnapshotSpool spool(folder_.path().string());
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));  // the spool file is unlinked
  spool.append(first);
  spool.append(second);
  for (int time = 0; time < 2; ++time) {  // may be read repeatedly
    spool.rewind();
    session::WorldSnapshot read;
    ASSERT_TRUE(spool.next(read));
    EXPECT_EQ(read.time, first.time);
    EXPECT_EQ(read.nodes, first.nodes);
    EXPECT_EQ(read.stress, first.stress);
    EXPECT_EQ(read.depths, first.depths);
    ASSERT_EQ(read.bones.size(), 1u);
    EXPECT_EQ(read.bones[0].rotation.coeffs(), first.bones[0].rotation.coeffs());
    EXPECT_EQ(read.bones[0].translation, first.bones[0].translation);
    EXPECT_EQ(read.tools[0].translation, first.tools[0].translation);
    EXPECT_FALSE(read.handle.has_value());
    ASSERT_TRUE(spool.next(read));
    EXPECT_EQ(read.time, second.time);
    EXPECT_TRUE(read.nodes.empty());
    ASSERT_TRUE(read.handle.has_value());
    EXPECT_EQ(read.handle->rotation.coeffs(), second.handle->rotation.coeffs());
    EXPECT_FALSE(spool.next(read));
  }
  EXPECT_THROW(session::SnapshotSpool((folder_ / "none").string()), Error);
}

TEST_F(Pictures, AStopEndsDrawingAndTheMovieIsComplete) {
  const auto world = loop::assemble(blocks(false));
  session::MovieFrames frames(*world, folder_.path().string(), session::Shade::kDisplacement, 0.01, 0.04,
                              {240, 218});
  ASSERT_TRUE(run(*world, frames).status.ok());
  std::atomic<bool> stop{false};
  session::Callbacks callbacks;
  callbacks.progress = [&stop](double share) { stop = share > 0.4; };
  callbacks.stop = &stop;
  MissingOutputs missing;
  const auto movie = session::make_movie((folder_ / "all.png").string(), 0.01);
  frames.save(*world, {movie.get()}, callbacks, missing);
  EXPECT_EQ(movie->written(), 2);
  EXPECT_TRUE(missing.empty());
  EXPECT_TRUE(std::filesystem::exists(folder_ / "all.png"));
}

TEST_F(Pictures, AFrameThatCannotBeWrittenIsNamed) {
  const auto world = loop::assemble(blocks(false));
  session::MovieFrames frames(*world, folder_.path().string(), session::Shade::kDisplacement, 0.01, 0.04,
                              {240, 218});
  ASSERT_TRUE(run(*world, frames).status.ok());
  MissingOutputs missing;
  std::filesystem::create_directories(folder_ / "frames/0002.part");  // blocks the temporary file
  const auto folder = session::make_frame_folder((folder_ / "frames").string());
  const auto movie = session::make_movie((folder_ / "all.png").string(), 0.01);
  frames.save(*world, {folder.get(), movie.get()}, {}, missing);
  EXPECT_EQ(folder->written(), 2);
  EXPECT_EQ(movie->written(), 4);  // the movie is complete all the same
  EXPECT_TRUE(std::filesystem::exists(folder_ / "all.png"));
  ASSERT_EQ(missing.outputs().size(), 1u);
  const std::string named = "frame " + (folder_ / "frames/0002.png").string() + " and all later frames (";
  EXPECT_TRUE(missing.outputs()[0].starts_with(named)) << missing.outputs()[0];
  EXPECT_TRUE(std::filesystem::exists(folder_ / "frames/0001.png"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "frames/0002.png"));
}
