#include "render/field.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/counters.h"
#include "palpate/core/error.h"

using namespace palpate;

TEST(Field, PaintsEachValueRowsFromBelow) {
  render::Field field{2, 2, {0.0, 1.0, std::nan(""), 0.5}};
  const long before = counters::counter("render.picture");
  const render::Picture picture = render::draw_field(field, {"depth", "m"}, "", 100);
  EXPECT_EQ(counters::counter("render.picture"), before + 1);
  ASSERT_GT(picture.width, 200);
  ASSERT_GT(picture.height, 200);
  const int left = 28, top = 56;
  const auto expect = [&](int x, int y, double t) {
    const render::Rgb c = render::ramp(t);
    EXPECT_NEAR(picture.pixel(x, y)[0], 255.0 * c.r, 1.0);
    EXPECT_NEAR(picture.pixel(x, y)[1], 255.0 * c.g, 1.0);
    EXPECT_NEAR(picture.pixel(x, y)[2], 255.0 * c.b, 1.0);
  };
  expect(left + 50, top + 150, 0.0);                      // lower left
  expect(left + 150, top + 150, 1.0);                     // lower right
  expect(left + 150, top + 50, 0.5);                      // upper right
  EXPECT_GT(picture.pixel(left + 50, top + 50)[0], 230);  // no value: pale
}

TEST(Field, RefusesAMisfit) {
  try {
    render::draw_field({3, 2, {1.0}}, {}, "");
    FAIL() << "1 value for 3 x 2 was accepted";
  } catch (const Error& e) { EXPECT_STREQ(e.what(), "picture of a field: 1 values for 3 x 2"); }
}

// The deepest value has the colour of the scale's end, and the others their colours, whatever surrounds the
// field.
TEST(Field, TheGreatestValueHasTheColourOfTheMaximum) {
  render::Field field{3, 2, {1e-3, 2e-3, 4e-3, std::nan(""), 3e-3, 0.0}};
  field.cell = 1e-4;
  const int magnify = 60, left = 28, top = 88 + 28;
  const render::Picture picture =
      render::draw_field(field, {"penetration", "m", 0.0}, "a title", magnify, "a line under it");
  const auto expect = [&](int column, int row, double t) {
    const render::Rgb c = render::ramp(t);
    const std::uint8_t* p =
        picture.pixel(left + column * magnify + magnify / 2, top + (1 - row) * magnify + magnify / 2);
    EXPECT_NEAR(p[0], 255.0 * c.r, 1.0) << column << ", " << row;
    EXPECT_NEAR(p[1], 255.0 * c.g, 1.0) << column << ", " << row;
    EXPECT_NEAR(p[2], 255.0 * c.b, 1.0) << column << ", " << row;
  };
  expect(2, 0, 1.0);
  expect(0, 0, 0.25);
  expect(1, 1, 0.75);
  expect(2, 1, 0.0);
}

// The scale bar under the field has the stated length: 60 pixels are a tenth of a millimetre, at most half of
// three cells.
TEST(Field, TheLengthIsToScale) {
  render::Field field{10, 2, std::vector<double>(20, 1.0)};
  field.cell = 1e-4;
  const int magnify = 60;
  const render::Picture picture = render::draw_field(field, {"depth", "m"}, "", magnify);
  const int row = picture.height - 16 - 6;
  int dark = 0;
  for (int x = 0; x < 28 + 2 * magnify + 8; ++x) dark += picture.pixel(x, row)[0] < 60;
  // an eighth of 1 mm rounded up: 0.2 mm, which are two cells
  EXPECT_NEAR(dark, 2 * magnify, 2);
}

TEST(Field, ATitleIsNeverCutOff) {
  const render::Field field{2, 2, {0.0, 1.0, 2.0, 3.0}};
  const std::string title(80, 'm');
  EXPECT_GT(render::draw_field(field, {}, title, 20).width,
            render::draw_field(field, {}, "m", 20).width + 500);
}
