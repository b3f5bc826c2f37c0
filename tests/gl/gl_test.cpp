#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <thread>

#include "palpate/core/counters.h"
#include "palpate/core/error.h"
#include "palpate/gl/buffer.h"
#include "palpate/gl/context.h"
#include "palpate/gl/framebuffer.h"
#include "palpate/gl/program.h"

using namespace palpate;

TEST(GlContext, OpensOnceAndSaysWhatItIs) {
  gl::Context& context = gl::Context::shared();
  EXPECT_TRUE(gl::Context::opened());
  EXPECT_EQ(&gl::Context::shared(), &context);
  EXPECT_EQ(counters::counter("gl.context").load(), 1);
  EXPECT_FALSE(context.info().renderer.empty());
  EXPECT_NE(context.info().version.find("4."), std::string::npos);
  RecordProperty("renderer", context.info().renderer);
}

TEST(GlContext, MissingLibraryNamesThePackage) {
  try {
    gl::require_library("libpalpate-does-not-exist.so.7", "libegl1");
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("libpalpate-does-not-exist.so.7"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("install the package libegl1"), std::string::npos) << e.what();
  }
}

TEST(GlContext, AnotherThreadTakesItOnlyAfterRelease) {
  gl::Context& context = gl::Context::shared();
  bool refused = false, taken = false;
  std::thread([&] {
    try {
      context.make_current();
    } catch (const InternalError& e) { refused = std::string(e.what()).find("release") != std::string::npos; }
  }).join();
  context.release();
  std::thread([&] {
    context.make_current();
    taken = glGetString(GL_VERSION) != nullptr;
    context.release();
  }).join();
  context.make_current();
  EXPECT_TRUE(refused);
  EXPECT_TRUE(taken);
}

TEST(GlProgram, UnknownShaderAndUniformAreNamed) {
  gl::Context::shared();
  // two vertex shaders: does not link
  EXPECT_THROW(gl::Program("contact/patch.vert", "contact/patch.vert"), InternalError);
  try {
    gl::shader_source("contact/patch.vrt");
    FAIL();
  } catch (const InternalError& e) {
    EXPECT_NE(std::string(e.what()).find("did you mean \"contact/patch.vert\""), std::string::npos)
        << e.what();
  }
  gl::Program program("contact/patch.vert", "contact/patch.frag");
  EXPECT_THROW(program.set("sclae", 1.0f), InternalError);
  gl::check_errors("the test");
}

// A triangle over the lower left half of a 4 x 4 image covers the pixels whose centre has x + y < 4 (x, y in
// pixels from the corner): rows of 3 (centre 3.5 + 0.5 = 4 lies on the edge), 2, 1 and 0 pixels inside; those
// on the edge may go either way.
TEST(GlFramebuffer, DrawsIdsAndDepthWhereTheTriangleIs) {
  gl::Context::shared();
  gl::Framebuffer target(4, 4, {gl::Format::kR32ui}, gl::DepthBuffer::kDepth);
  gl::Program program("contact/patch.vert", "contact/patch.frag");
  program.set("scale", Eigen::Vector3f(1, 1, 1));
  program.set("shift", Eigen::Vector3f(0, 0, 0));
  gl::Buffer vertices;
  vertices.upload(std::vector<float>{-1, -1, 0.5f, 1, -1, 0.5f, -1, 1, 0.5f});
  gl::VertexArray layout;
  layout.attribute(0, vertices, 3, 12);
  target.clear(0, 0u);
  target.clear_depth(1.0f);
  target.bind();
  program.use();
  layout.bind();
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  const auto ids = target.read_r32ui();
  const auto depth = target.read_depth();
  int inside = 0;
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) {
      const auto at = static_cast<std::size_t>(4 * y + x);
      if (x + y < 3) {
        EXPECT_EQ(ids[at], 1u) << x << " " << y;
        EXPECT_NEAR(depth[at], 0.75, 1e-6);
        ++inside;
      } else if (x + y > 3) {
        EXPECT_EQ(ids[at], 0u) << x << " " << y;
        EXPECT_EQ(depth[at], 1.0f);
      }
    }
  EXPECT_EQ(inside, 6);
}

TEST(GlFramebuffer, ReadsBackColoursAndRefusesWrongFormatsAndSizes) {
  gl::Context::shared();
  gl::Framebuffer target(3, 2, {gl::Format::kRgba8, gl::Format::kR32ui}, gl::DepthBuffer::kNone);
  const float colour[4] = {1.0f, 0.0f, 0.2f, 1.0f};
  target.clear(0, colour);
  target.clear(1, 7u);
  const auto pixels = target.read_rgba8(0);
  ASSERT_EQ(pixels.size(), 24u);
  EXPECT_EQ(pixels[0], 255);
  EXPECT_EQ(pixels[2], 51);
  EXPECT_EQ(target.read_r32ui(1).at(5), 7u);
  EXPECT_THROW(target.read_r32ui(0), InternalError);
  EXPECT_THROW(target.read_depth(), InternalError);
  try {
    gl::Texture(0, 8, gl::Format::kRgba8);
    FAIL();
  } catch (const Error& e) { EXPECT_NE(std::string(e.what()).find("0 x 8"), std::string::npos); }
}

TEST(GlBuffer, GrowsReadsAndWrites) {
  gl::Context::shared();
  gl::Buffer buffer;
  buffer.upload(std::vector<int>{1, 2, 3, 4});
  const int nine = 9;
  buffer.write(&nine, sizeof nine, 8);
  int out[4] = {};
  buffer.read(out, sizeof out);
  EXPECT_EQ(out[1], 2);
  EXPECT_EQ(out[2], 9);
  EXPECT_THROW(buffer.read(out, sizeof out, 4), InternalError);
  buffer.reserve(1000);
  EXPECT_EQ(buffer.capacity(), 1000u);
  gl::check_errors("the test");
}
