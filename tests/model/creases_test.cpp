#include "model/creases.h"

#include <gtest/gtest.h>

#include <cmath>

#include "surfaces.h"

using namespace palpate;

namespace {

TEST(Creases, PartsHaveThem) {
  EXPECT_EQ(model::crease_angle(surfaces::box()), 50.0);
  EXPECT_EQ(model::crease_angle(mesh::cylinder_surface(1.0, 2.0, 0.2)), 50.0);
}

TEST(Creases, GrownShapesHaveNone) {
  EXPECT_EQ(model::crease_angle(surfaces::ball()), std::nullopt);
  TriMesh rough = surfaces::ball(1.0, 24);  // some of its faces form sharp angles
  for (Eigen::Index i = 0; i < rough.vertices.cols(); i += 5)
    rough.vertices.col(i) *= 1 + 0.06 * std::sin(static_cast<double>(i));
  EXPECT_EQ(model::crease_angle(rough), std::nullopt);
}

}  // namespace
