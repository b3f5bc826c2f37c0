#include "render/corners.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "render/shapes.h"

using namespace palpate;

namespace {
Vec3 vec(const float* v) { return {v[0], v[1], v[2]}; }
}  // namespace

TEST(Corners, KeepACubesEdgesSharp) {
  const render::Surface cube = cube_surface();
  const auto corners = render::corners(cube, {"", "", 0, 1}, Vec3::Zero());
  ASSERT_EQ(corners.size(), 36u);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 n = vec(corners[i].normal), p = vec(corners[i].position);
    EXPECT_NEAR(n.cwiseAbs().maxCoeff(), 1.0, 1e-6);                // along an axis
    EXPECT_NEAR((p - Vec3::Constant(0.5)).dot(n), 0.5, 1e-6) << i;  // outwards
  }
}

TEST(Corners, RoundOffWhatIsSmooth) {
  const Vec3 centre(5, -3, 2);
  const render::Surface ball = ball_surface(centre, 0.7, 40);
  for (const auto& corner : render::corners(ball, {"", "", 0, 1}, centre))
    // within half a band of radial
    EXPECT_GT(vec(corner.normal).dot(vec(corner.position) / 0.7), std::cos(0.04));
}

TEST(Corners, ScaleTheirValuesAndMarkThePlain) {
  render::Surface cube = cube_surface();
  EXPECT_LT(render::corners(cube, {"", "", 0, 1}, Vec3::Zero())[0].value, -1.0f);
  cube.values = VecX::LinSpaced(8, 0.0, 7.0);
  cube.values[3] = std::nan("");
  int plain = 0;
  const auto corners = render::corners(cube, {"", "", 1.0, 5.0}, Vec3::Zero());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const int point = cube.faces(static_cast<int>(i) % 3, static_cast<int>(i) / 3);
    if (point == 3) {
      EXPECT_LT(corners[i].value, -1.0f);
      ++plain;
    } else {
      EXPECT_FLOAT_EQ(corners[i].value, static_cast<float>(std::clamp((point - 1.0) / 4.0, 0.0, 1.0)));
    }
  }
  EXPECT_GT(plain, 0);
}
