#include "palpate/render/field.h"

#include <gtest/gtest.h>

#include <cmath>

#include "palpate/core/counters.h"
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
    const render::Rgb c = render::viridis(t);
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
