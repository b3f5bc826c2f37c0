#include "shapes/shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "mesh/surface_checks.h"
#include "palpate/core/error.h"
#include "palpate/mesh/boundary.h"
#include "shapes/gear_profile.h"
#include "shapes/human.h"
#include "shapes/surface_facts.h"

using namespace palpate;
using shapes::Shape;

namespace {

void expect_sound(TriMesh surface, int vertices, int euler, double angle_deg, const std::string& name) {
  const TriMesh before = surface;
  const mesh::MeshReport report = mesh::check_surface(surface, mesh::surface_provenance(name));
  EXPECT_EQ(report.flipped, 0) << name;
  EXPECT_GT(report.volume, 0.0) << name;
  EXPECT_EQ(surface.vertices, before.vertices) << name;
  EXPECT_NEAR(static_cast<double>(surface.vertices.cols()), vertices, 0.01 * vertices) << name;
  EXPECT_EQ(pieces(surface), 1) << name;
  EXPECT_EQ(euler_characteristic(surface), euler) << name;
  EXPECT_GT(smallest_angle_deg(surface), angle_deg) << name;
  long looked_at = 0;
  EXPECT_EQ(self_intersections(surface, &looked_at), 0) << name;
  EXPECT_GT(looked_at, 2 * surface.faces.cols()) << name;
  std::printf("%s: %d vertices, smallest angle %.1f degrees, %.5g m^3, %ld pairs of faces tested\n",
              name.c_str(), static_cast<int>(surface.vertices.cols()), smallest_angle_deg(surface),
              report.volume, looked_at);
}

void expect_sound(const Shape& shape, const shapes::Resolution& asked) {
  const int euler = shape.name == "gear" ? 0 : 2;  // the gear has a bore
  expect_sound(shape.base, asked.base_vertices, euler, 10.0, shape.name + ", base");
  expect_sound(shape.skin, asked.skin_vertices, euler, 10.0, shape.name + ", skin");
}

/// The skin is embedded in tetrahedra that fill the base; inner vertices are contained, and outer ones must
/// not be far outside. A regular tetrahedron of the requested number has the edge (6 sqrt 2 V / n)^(1/3).
void expect_close(const Shape& shape) {
  const double edge = std::cbrt(6.0 * std::sqrt(2.0) * mesh::enclosed_volume(shape.base) / shape.tetrahedra);
  double outside = 0.0, off_base = 0.0;
  for (Eigen::Index v = 0; v < shape.skin.vertices.cols(); ++v)
    outside = std::max(outside, shape.inside(shape.skin.vertices.col(v)));
  for (Eigen::Index v = 0; v < shape.base.vertices.cols(); ++v)
    off_base = std::max(off_base, std::abs(shape.inside(shape.base.vertices.col(v))));
  std::printf(
      "%s: skin to %.2g m outside the base, a tetrahedron's edge is %.2g m; base within %.2g m of its "
      "function\n",
      shape.name.c_str(), outside, edge, off_base);
  EXPECT_LT(outside, 0.6 * edge) << shape.name;
  EXPECT_LT(off_base, 1e-4) << shape.name;
}

/// Checks realistic sizes [m].
void expect_size(const Shape& shape) {
  const Vec3 extent = shape.skin.vertices.rowwise().maxCoeff() - shape.skin.vertices.rowwise().minCoeff();
  if (shape.name == "human") {
    EXPECT_NEAR(extent.z(), 1.75, 0.02);
    EXPECT_NEAR(shape.skin.vertices.row(2).minCoeff(), 0.0, 0.005);
    EXPECT_NEAR(mesh::enclosed_volume(shape.base), 0.07, 0.012);  // about 70 kg of water
  } else if (shape.name == "head") {
    EXPECT_NEAR(extent.z(), 0.24 + 0.066, 0.01);  // the neck extends below the chin
  } else if (shape.name == "gear") {
    EXPECT_NEAR(extent.x(), 0.10, 0.001);
    EXPECT_NEAR(extent.z(), 0.02, 1e-12);
  } else if (shape.name == "ball") {
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(extent[axis], 0.06, 1e-3);
  } else {
    EXPECT_EQ(shape.name, "pumpkin");
    EXPECT_NEAR(extent.x(), 0.30, 0.015);
  }
}

class EveryShape : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Shapes, EveryShape, testing::ValuesIn(names(shapes::shapes())),
                         [](const auto& test) { return test.param; });

TEST_P(EveryShape, IsSoundAndTheSameEachTimeAtItsLeastResolution) {
  const shapes::Resolution least = find(shapes::shapes(), GetParam(), "shape").least;
  const Shape one = shapes::make(GetParam(), least), other = shapes::make(GetParam(), least);
  expect_sound(one, least);
  EXPECT_TRUE(one.base.vertices == other.base.vertices && one.base.faces == other.base.faces);
  EXPECT_TRUE(one.skin.vertices == other.skin.vertices && one.skin.faces == other.skin.faces);
}

TEST_P(EveryShape, IsSoundAtItsUsualCounts) {
  const shapes::ShapeEntry& entry = find(shapes::shapes(), GetParam(), "shape");
  const std::map<std::string, int> paper = {
      {"head", 44000}, {"human", 40000}, {"gear", 29000}, {"pumpkin", 30000}};
  const bool of_the_paper = GetParam() != "ball";
  if (of_the_paper) { EXPECT_EQ(entry.usual.skin_vertices, paper.at(GetParam())); }
  EXPECT_FALSE(entry.summary.empty());
  const Shape shape = shapes::make(GetParam());
  expect_sound(shape, entry.usual);
  expect_size(shape);
  EXPECT_GE(shape.tetrahedra, of_the_paper ? 10000 : 1000);
  EXPECT_EQ(static_cast<bool>(shape.inside), GetParam() != "gear");
  if (shape.inside) expect_close(shape);
  if (GetParam() == "head" || GetParam() == "human") {
    EXPECT_TRUE(is_its_mirror_image(shape.base));
    EXPECT_TRUE(is_its_mirror_image(shape.skin));
  }
  EXPECT_EQ(shape.skeleton.bones.size(), GetParam() == "human" ? 19U : 0U);
}

// The base is a prism: its area in closed form times its width, except for polygons that approximate arcs,
// with an error of O(edge^2).
TEST(Shapes, GearHasItsVolumeInClosedForm) {
  const shapes::GearSize size;
  const double exact = (shapes::gear_area(size) - std::numbers::pi * size.bore * size.bore) * size.width;
  const Shape gear = shapes::make("gear", {29000, 12000});
  const double base = mesh::enclosed_volume(gear.base);
  EXPECT_NEAR(base / exact, 1.0, 1e-3);
  // The first two creases are the upper outline and bore: between their polygons the prism is exact.
  // (gear_profile_test.cpp shows that the outline's polygon converges to its closed form.)
  const auto area = [](const std::vector<Vec3>& line) {
    double sum = 0.0;
    for (std::size_t i = 0; i + 1 < line.size(); ++i) sum += 0.5 * line[i].cross(line[i + 1]).z();
    return sum;
  };
  EXPECT_EQ(gear.creases[0].front(), gear.creases[0].back());
  EXPECT_NEAR(base / ((area(gear.creases[0]) - area(gear.creases[1])) * size.width), 1.0, 1e-12);
  // The skin lacks two recesses, each a ring of trapezoidal section (Pappus: by the centroids of its parts),
  // and chamfers along outline and bore. Volume of a frustum:
  const auto cone = [](double r0, double r1, double depth) {
    return std::numbers::pi * depth / 3.0 * (r1 * r1 + r1 * r0 + r0 * r0);
  };
  const double recess = cone(0.037, 0.0355, 0.0015) - cone(0.020, 0.0215, 0.0015);
  const double bore_chamfer = cone(0.0133, 0.0125, 0.0008) - std::numbers::pi * 0.0125 * 0.0125 * 0.0008;
  double outline = 0.0;
  const auto profile = shapes::gear_profile(size, 1e-4);
  for (std::size_t i = 0; i < profile.points.size(); ++i)
    outline += (profile.points[(i + 1) % profile.points.size()] - profile.points[i]).norm();
  const double chamfer = 0.5 * 0.0005 * 0.0005 * outline;
  EXPECT_NEAR(mesh::enclosed_volume(gear.skin) / (exact - 2.0 * (recess + bore_chamfer + chamfer)), 1.0,
              1e-3);
}

// Creases pass through vertices of the base, edge by edge, and every sharp edge of the base lies on one.
TEST(Shapes, CreasesAreTheSharpEdgesOfTheGear) {
  const Shape gear = shapes::make("gear", {12000, 8000});
  EXPECT_EQ(gear.creases.size(), 4U + 46U);
  std::map<std::array<double, 3>, int> number;
  for (Eigen::Index v = 0; v < gear.base.vertices.cols(); ++v)
    number[{gear.base.vertices(0, v), gear.base.vertices(1, v), gear.base.vertices(2, v)}] =
        static_cast<int>(v);
  std::set<std::pair<int, int>> creased;
  for (const auto& line : gear.creases) {
    ASSERT_GE(line.size(), 2U);
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
      const auto a = number.find({line[i].x(), line[i].y(), line[i].z()}),
                 b = number.find({line[i + 1].x(), line[i + 1].y(), line[i + 1].z()});
      ASSERT_TRUE(a != number.end() && b != number.end());
      creased.insert(std::minmax(a->second, b->second));
    }
  }
  std::map<std::pair<int, int>, std::vector<Vec3>> normals;
  for (Eigen::Index f = 0; f < gear.base.faces.cols(); ++f) {
    const Vec3 n = (vertex(gear.base, f, 1) - vertex(gear.base, f, 0))
                       .cross(vertex(gear.base, f, 2) - vertex(gear.base, f, 0))
                       .normalized();
    for (int k = 0; k < 3; ++k)
      normals[std::minmax(gear.base.faces(k, f), gear.base.faces((k + 1) % 3, f))].push_back(n);
  }
  int sharp = 0;
  for (const auto& [edge, n] : normals) {
    ASSERT_EQ(n.size(), 2U);
    if (n[0].dot(n[1]) > std::cos(50.0 * std::numbers::pi / 180.0)) continue;
    EXPECT_TRUE(creased.count(edge)) << edge.first << " " << edge.second;
    ++sharp;
  }
  EXPECT_EQ(sharp, static_cast<int>(creased.size()));
}

TEST(Shapes, RefuseWhatTheyCannotMake) {
  try {
    shapes::make("pumkin");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("pumpkin"), std::string::npos) << error.what();
  }
  try {
    shapes::make("human", {100, 0});
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("skin_vertices = 100"), std::string::npos) << error.what();
  }
  EXPECT_THROW(shapes::make("head", {0, -5}), Error);
}

}  // namespace
