#include "render/animation.h"

#include <cairo.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "messages.h"
#include "palpate/core/error.h"
#include "temporary_folder.h"

// tests/cli/movie_test.py checks with an independent reader that every picture is recovered, pixel by pixel.

using namespace palpate;
using expectations::expect_contains;
using expectations::message_of;
using render::AnimationWriter;
using render::Picture;

namespace {

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

int count(const std::string& text, const std::string& word) {
  int n = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++n;
  return n;
}

Picture noise(int width, int height) {
  Picture out(width, height, {});
  std::uint32_t x = 1;
  for (std::size_t i = 0; i < out.rgba.size(); ++i)
    if (i % 4 != 3) out.rgba[i] = static_cast<std::uint8_t>((x = 1664525 * x + 1013904223) >> 24);
  return out;
}

}  // namespace

TEST(Animation, WhatDoesNotMoveCostsNothing) {
  const TemporaryFolder folder;
  const Picture still = noise(200, 100);
  const auto size = [&](int pictures) {
    AnimationWriter writer(folder / "still.png", 0.04);
    for (int i = 0; i < pictures; ++i) writer.add(still);
    writer.close();
    const std::string bytes = bytes_of(folder / "still.png");
    EXPECT_EQ(count(bytes, "fcTL"), pictures);
    EXPECT_EQ(count(bytes, "fdAT"), pictures - 1);
    EXPECT_EQ(bytes.substr(bytes.size() - 8, 4), "IEND");
    return bytes.size();
  };
  const std::size_t one = size(1);
  EXPECT_GT(one, 60000u);  // noise is incompressible
  EXPECT_LT(size(101) - one, 100u * 100u);
}

// For programs that support PNG only.
TEST(Animation, ItsFirstPictureIsAPngOfItsOwn) {
  const TemporaryFolder folder;
  const Picture first = noise(50, 30);
  AnimationWriter writer(folder / "two.png", 0.5);
  writer.add(first);
  writer.add(Picture(50, 30, {}));
  writer.close();
  cairo_surface_t* surface = cairo_image_surface_create_from_png((folder / "two.png").c_str());
  ASSERT_EQ(cairo_surface_status(surface), CAIRO_STATUS_SUCCESS);
  ASSERT_EQ(cairo_image_surface_get_width(surface), 50);
  ASSERT_EQ(cairo_image_surface_get_height(surface), 30);
  const unsigned char* data = cairo_image_surface_get_data(surface);
  int same = 0;
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 50; ++x) {
      const unsigned char* p = data + y * cairo_image_surface_get_stride(surface) + 4 * x;  // B, G, R
      const std::uint8_t* q = first.pixel(x, y);
      same += p[2] == q[0] && p[1] == q[1] && p[0] == q[2];
    }
  cairo_surface_destroy(surface);
  EXPECT_EQ(same, 50 * 30);
}

TEST(Animation, RefusesWhatItCannotWrite) {
  const TemporaryFolder folder;
  expect_contains(message_of([&] { AnimationWriter(folder / "no/such.png", 0.04); }),
                  "no/such.png: the animation cannot be written: No such file or directory");
  AnimationWriter writer(folder / "a.png", 0.04);
  writer.add(Picture(20, 20, {}));
  EXPECT_THROW(writer.add(Picture(20, 22, {})), InternalError);
  AnimationWriter full("/dev/full", 0.04);
  expect_contains(message_of([&] { full.add(noise(200, 200)); }), "No space left on device");
  AnimationWriter late("/dev/full", 0.04);  // so little data that the error occurs at the end
  late.add(Picture(20, 20, {}));
  expect_contains(message_of([&] { late.close(); }), "No space left on device");
  EXPECT_THROW(AnimationWriter(folder / "none.png", 0.04).close(), InternalError);
  EXPECT_THROW(AnimationWriter(folder / "none.png", 0.0), InternalError);
}

TEST(Animation, DurationsAreFractionsOfSmallNumbers) {
  const auto is = [](double seconds, int numerator, int denominator) {
    const render::Fraction f = render::fraction_of(seconds);
    EXPECT_EQ(f.numerator, numerator) << seconds;
    EXPECT_EQ(f.denominator, denominator) << seconds;
  };
  is(0.04, 400, 10000);
  is(1.0 / 30.0, 333, 10000);
  is(6.5535, 65535, 10000);
  is(6.6, 6600, 1000);
  is(70.0, 7000, 100);
  is(1e6, 65535, 1);
  is(1e-9, 1, 10000);
}
