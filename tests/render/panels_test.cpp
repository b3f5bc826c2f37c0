#include "render/panels.h"

#include <gtest/gtest.h>

#include <cmath>

#include "palpate/core/error.h"

using namespace palpate;
using render::Picture;

namespace {

/// Column of the vertical mark in a strip of `height` under a picture, found by its colour.
int mark(const Picture& page, int picture_height, int height) {
  for (int x = 0; x < page.width; ++x) {
    const std::uint8_t* p = page.pixel(x, picture_height + height / 2);
    if (p[0] > 180 && p[1] < 110 && p[2] < 60) return x;
  }
  return -1;
}

}  // namespace

TEST(Panels, StandSideBySide) {
  const Picture page =
      render::beside({Picture(20, 16, {1, 0, 0}), Picture(30, 16, {0, 1, 0}), Picture(10, 16, {0, 0, 1})});
  EXPECT_EQ(page.width, 60);
  EXPECT_EQ(page.height, 16);
  EXPECT_EQ(page.pixel(19, 15)[0], 255);
  EXPECT_EQ(page.pixel(20, 0)[1], 255);
  EXPECT_EQ(page.pixel(49, 8)[1], 255);
  EXPECT_EQ(page.pixel(50, 8)[2], 255);
  EXPECT_THROW(render::beside({Picture(20, 16, {}), Picture(20, 17, {})}), InternalError);
}

TEST(Curve, StandsUnderThePictureAndItsMarkMovesEvenly) {
  const render::Curve curve{"force", "N", {0.0, 0.1, 0.2, 0.3, 0.4}, {0.0, 1.0, 3.0, 2.0, 0.0}};
  const Picture above(600, 100, {0.2f, 0.4f, 0.6f});
  const int height = 150;
  std::vector<int> marks;
  for (const double t : {0.0, 0.1, 0.2, 0.3, 0.4}) {
    const Picture page = render::with_curve(above, curve, t, height);
    EXPECT_EQ(page.width, 600);
    EXPECT_EQ(page.height, 250);
    EXPECT_EQ(page.pixel(599, 99)[0], above.pixel(599, 99)[0]);  // unchanged
    marks.push_back(mark(page, 100, height));
    ASSERT_GE(marks.back(), 0);
  }
  for (std::size_t i = 2; i < marks.size(); ++i)
    EXPECT_NEAR(marks[i] - marks[i - 1], marks[1] - marks[0], 1.0);
  EXPECT_GT(marks[1] - marks[0], 80);
  // pages of one curve differ at the marks only
  const Picture one = render::with_curve(above, curve, 0.1, height),
                two = render::with_curve(above, curve, 0.2, height);
  for (int y = 0; y < one.height; ++y)
    for (int x = 0; x < one.width; ++x)
      if (std::abs(x - marks[1]) > 4 && std::abs(x - marks[2]) > 4) {
        ASSERT_EQ(one.pixel(x, y)[0], two.pixel(x, y)[0]);
      }
}

TEST(Curve, NothingButZeroHasAScaleToo) {
  const render::Curve curve{"force", "N", {0.0, 0.0}, {0.0, 0.0}};
  EXPECT_GE(mark(render::with_curve(Picture(400, 20, {}), curve, 0.0, 150), 20, 150), 0);
}
