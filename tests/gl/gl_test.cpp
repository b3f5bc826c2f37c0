#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <thread>

#include "core/counters.h"
#include "gl/buffer.h"
#include "gl/context.h"
#include "gl/framebuffer.h"
#include "gl/program.h"
#include "palpate/core/error.h"

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

// On a machine without GPU, both Mesa's surfaceless platform and its software device would work: the one that
// could have been hardware is tried first, in whatever order EGL lists them.
TEST(GlContext, WhatMayBeHardwareIsTriedFirst) {
  const gl::ContextInfo& info = gl::Context::shared().info();
  const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  if (!info.software || !std::strstr(extensions, "EGL_MESA_platform_surfaceless"))
    GTEST_SKIP() << "a GPU, or no surfaceless platform: " << info.renderer;
  EXPECT_EQ(info.platform, "surfaceless");
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

// Runs in a separate process whose EGL has no driver: a gtest "death test" that restarts this program.
TEST(GlContextDeathTest, NoDriverSaysWhatToInstall) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto open = [] {
    ::setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/nowhere", 1);
    try {
      gl::Context::shared();
    } catch (const Error& error) {
      std::fputs(error.what(), stderr);
      std::exit(3);
    }
    std::exit(0);
  };
  EXPECT_EXIT(open(), ::testing::ExitedWithCode(3), "install .*libegl-mesa0");
}

TEST(GlContext, AnotherThreadTakesItOnlyAfterRelease) {
  gl::Context& context = gl::Context::shared();
  bool refused = false, taken = false;
  std::thread([&] {
    try {
      context.make_current();
    } catch (const Error& e) { refused = std::string(e.what()).find("another thread") != std::string::npos; }
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

TEST(GlContext, ObjectsThatAnotherThreadDropsAreDeletedByTheNextOwner) {
  gl::Context& context = gl::Context::shared();
  std::optional<gl::Buffer> here(std::in_place), there(std::in_place);
  const unsigned first = here->id(), second = there->id();
  for (gl::Buffer* buffer : {&*here, &*there}) buffer->upload("", 1);
  here.reset();
  EXPECT_FALSE(glIsBuffer(first));
  std::thread([&] { there.reset(); }).join();
  EXPECT_TRUE(glIsBuffer(second));
  context.release();
  context.make_current();
  EXPECT_FALSE(glIsBuffer(second));
}

TEST(GlProgram, UnknownShaderAndUniformAreNamed) {
  // each is valid, but the second reads an output that the first does not write: an error, which NVIDIA's
  // driver tolerates
  if (gl::Context::shared().info().software) {
    EXPECT_THROW(gl::Program("contact/skin.vert", "render/surface.frag"), InternalError);
  }
  try {
    gl::shader_source("contact/skin.vrt");
    FAIL();
  } catch (const InternalError& e) {
    EXPECT_NE(std::string(e.what()).find("did you mean \"contact/skin.vert\""), std::string::npos)
        << e.what();
  }
  gl::Program program("contact/skin.vert", "contact/skin.frag");
  EXPECT_THROW(program.set("first_pont", 1u), InternalError);
  gl::check_errors("the test");
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
