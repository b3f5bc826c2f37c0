// Conformance suite of the obstacle registry. Shapes are generated at random from the entries' keys.
#include "contact/methods.h"
#include "distance/points.h"
#include "mesh/curvature.h"
#include "palpate/contact/obstacle.h"
#include "surfaces.h"

using namespace palpate;
using namespace contact_tests;
using contact::Nearest;
using contact::ObstacleEntry;

namespace {

/// Random spec: lengths of 0.3 to 0.7 m, any positions and directions.
ObstacleSpec random_spec(const ObstacleEntry& entry, std::mt19937& random) {
  const auto length = [&] { return 0.5 + 0.2 * uniform(random); };
  ObstacleSpec spec{"thing", entry.name, {}};
  for (const PartKey& key : entry.keys) {
    const bool positive = key.range.low >= 0.0;
    if (std::holds_alternative<double>(*key.fallback))
      spec.shape[key.name] = positive ? length() : uniform(random);
    else if (std::holds_alternative<Vec3>(*key.fallback))
      spec.shape[key.name] = positive ? Vec3(length(), length(), length()) : vector(random);
    else
      spec.shape[key.name] = *key.fallback;
  }
  return spec;
}

std::string refusal(const ObstacleSpec& spec) {
  try {
    contact::obstacle_shape(spec);
  } catch (const Error& e) { return e.what(); }
  return "accepted";
}

class Obstacle : public testing::TestWithParam<std::string> {
 protected:
  Obstacle() { renew(); }
  void renew() {
    spec = random_spec(entry, random);
    shape = contact::obstacle_shape(spec);
    const auto position = shape.find("position_m");
    centre = position == shape.end() ? Vec3(Vec3::Zero()) : std::get<Vec3>(position->second);
  }
  Vec3 near_by() { return centre + vector(random); }
  Nearest nearest(const Vec3& x) const { return entry.nearest(shape, x); }

  const ObstacleSpec named{"thing", GetParam(), {}};
  const ObstacleEntry& entry = contact::obstacle_entry(named);
  std::mt19937 random{20070322};
  ObstacleSpec spec;
  Settings shape;
  Vec3 centre;
};

// The shortest exit from the shape's centre is half of its thickness; a half-space has no centre.
TEST_P(Obstacle, ThicknessIsTheLeastWayThrough) {
  for (int i = 0; i < 20; ++i) {
    renew();
    const double half = 0.5 * entry.lengths(shape).width;
    ASSERT_GT(half, 0.0);
    for (int k = 0; k < 50; ++k) EXPECT_GE(nearest(near_by()).gap, -half - 1e-12);
    if (!std::isfinite(half)) continue;
    EXPECT_NEAR(nearest(centre).gap, -half, 1e-12);
  }
}

// The surface's corners lie on the shape, and it is closed. With corrections for the area and bulge that its
// triangles lack, coarse and fine surfaces have equal values of both. An unbounded shape has no surface.
TEST_P(Obstacle, SurfaceIsClosedAndFittedToTheShape) {
  for (int i = 0; i < 5; ++i) {
    renew();
    ASSERT_EQ(entry.surface == nullptr, !std::isfinite(entry.lengths(shape).width));
    if (!entry.surface) return;
    const auto measure = [&](double spacing) {
      const TriMesh surface = entry.surface(shape, spacing);
      for (const auto x : surface.vertices.colwise()) EXPECT_NEAR(nearest(x).gap, 0.0, 1e-12);
      const distance::Skin skin = distance::make_skin(surface);  // throws if not closed
      distance::ContactMesh mesh = distance::contact_mesh(skin, HUGE_VAL);
      Points at(3, static_cast<Eigen::Index>(mesh.points.size()));
      double volume = 0.0, area = 0.0;
      for (Eigen::Index p = 0; p < at.cols(); ++p) {
        const distance::ContactPoint& point = mesh.points[static_cast<std::size_t>(p)];
        at.col(p) = surface.vertices(Eigen::all, skin.faces.col(point.face)) * point.weights;
      }
      distance::fit_to_surface(mesh, at, [&](const Vec3& x) {
        const Nearest foot = nearest(x);
        return Vec3(x - foot.gap * foot.normal);
      });
      for (const distance::ContactTriangle& t : mesh.triangles) {
        const Mat3 x = at(Eigen::all, t.points).colwise() - centre;
        volume += x.determinant() / 6.0 + t.lowered * t.area;
        area += t.area;
      }
      return std::pair(area, volume);
    };
    const auto [area, volume] = measure(0.1);
    const auto [fine_area, fine_volume] = measure(0.0125);
    EXPECT_NEAR(area / fine_area, 1.0, 4e-3);  // the ends of a cylinder are polygons
    EXPECT_NEAR(volume / fine_volume, 1.0, 4e-3);
  }
}

// The radius agrees with the mean curvature of the shape's picture; an unbounded shape has none.
TEST_P(Obstacle, RadiusIsThatOfItsMeanCurvature) {
  for (int i = 0; i < 20; ++i) {
    renew();
    const double radius = entry.lengths(shape).radius;
    if (!std::isfinite(entry.lengths(shape).width)) {
      EXPECT_TRUE(std::isinf(radius));
      continue;
    }
    EXPECT_NEAR(mesh::mean_radius(entry.picture(shape, {}).surface) / radius, 1.0, 0.03);
  }
}

TEST_P(Obstacle, DescribesItsKeys) {
  EXPECT_GT(entry.summary.size(), 10u);
  std::vector<std::string> seen = {"name", "type"};
  for (const PartKey& key : entry.keys) {
    EXPECT_EQ(std::count(seen.begin(), seen.end(), key.name), 0) << key.name << " twice";
    seen.push_back(key.name);
    EXPECT_GE(key.meaning.size(), 8u) << key.name;
    ASSERT_TRUE(key.fallback) << key.name << ": its default says its type";
    EXPECT_EQ(fault_of(key, *key.fallback), "") << key.name;
  }
}

TEST_P(Obstacle, RefusesBadKeys) {
  EXPECT_EQ(refusal(spec), "accepted");
  for (const PartKey& key : entry.keys) {
    const auto with = [&](const Setting& value) {
      ObstacleSpec bad = spec;
      bad.shape[key.name] = value;
      return refusal(bad);
    };
    const double nan = std::nan("");
    const bool number = std::holds_alternative<double>(*key.fallback);
    if (!number && !std::holds_alternative<Vec3>(*key.fallback)) continue;
    const auto filled = [&](double x) { return number ? Setting(x) : Setting(Vec3(1.0, x, 1.0)); };
    EXPECT_NE(with(filled(nan)).find(key.name + " = "), std::string::npos) << with(filled(nan));
    EXPECT_NE(with(filled(std::numeric_limits<double>::infinity())), "accepted") << key.name;
    EXPECT_NE(with(std::string("wide")).find("must be "), std::string::npos) << key.name;
    EXPECT_NE(with(number ? Setting(Vec3(1, 1, 1)) : Setting(1.0)), "accepted") << key.name;
    if (std::isfinite(key.range.low)) {
      const double beyond = key.range.low_open ? key.range.low : key.range.low - 1.0;
      EXPECT_NE(with(filled(beyond)).find(key.range.demand()), std::string::npos) << key.name;
    }
    ObstacleSpec without = spec;
    without.shape.erase(key.name);
    EXPECT_EQ(refusal(without).find("is missing") != std::string::npos, key.required) << key.name;
  }
  ObstacleSpec unknown = spec;
  unknown.shape["colour_m"] = 1.0;
  EXPECT_NE(refusal(unknown).find("unknown key \"colour_m\""), std::string::npos) << refusal(unknown);
}

// The gap is a signed distance: it takes both signs, changes by no more than x does, and x - gap n is the
// nearest point of the surface for all points on the line to it.
TEST_P(Obstacle, GapIsASignedDistance) {
  int inside = 0, outside = 0;
  for (int round = 0; round < 20; ++round, renew())
    for (int i = 0; i < 200; ++i) {
      const Vec3 x = near_by(), y = near_by();
      const Nearest at = nearest(x);
      EXPECT_NEAR(at.normal.norm(), 1.0, 1e-13);
      EXPECT_LE(std::abs(at.gap - nearest(y).gap), (x - y).norm() * (1 + 1e-12));
      EXPECT_NEAR(nearest(x - at.gap * at.normal).gap, 0.0, 1e-13);
      const double s = 0.5 + 0.5 * uniform(random);
      if (at.gap > 0.0) { EXPECT_NEAR(nearest(x - s * at.gap * at.normal).gap, (1.0 - s) * at.gap, 1e-13); }
      EXPECT_GE(at.radius, 0.0);
      ++(at.gap < 0.0 ? inside : outside);
    }
  EXPECT_GT(inside, 40);
  EXPECT_GT(outside, 40);
}

// ap(x + h d) - gap(x) - h n.d| decreases as h^2, except where x is within h of a ridge (equally near to two
// faces, inside), which is rare.
TEST_P(Obstacle, NormalIsTheGradientOfTheGap) {
  int tried = 0, passed = 0;
  for (int round = 0; round < 20; ++round, renew())
    for (int i = 0; i < 50; ++i) {
      const Vec3 x = near_by(), d = vector(random).normalized();
      const Nearest at = nearest(x);
      const auto remainder = [&](double h) {
        return std::abs(nearest(x + h * d).gap - at.gap - h * at.normal.dot(d));
      };
      const double coarse = remainder(1e-3), fine = remainder(1e-4);
      ++tried;
      passed += fine <= 0.02 * coarse + 1e-14 && coarse < 1e-4;
    }
  EXPECT_GE(passed, 0.95 * tried) << passed << " of " << tried;
}

TEST_P(Obstacle, FarPointsKeepTheirDigits) {
  for (int i = 0; i < 100; ++i) {
    const Vec3 x = centre + 1e4 * vector(random).normalized();
    const Nearest at = nearest(x);
    EXPECT_TRUE(std::isfinite(at.gap) && at.normal.allFinite());
    EXPECT_LE(std::abs(at.gap), 1e4 + 2.0);
    EXPECT_NEAR(nearest(x - at.gap * at.normal).gap, 0.0, 1e-10);
  }
}

TEST_P(Obstacle, PointsOfTheSurfaceAndOfTheMiddleStayFinite) {
  EXPECT_TRUE(nearest(centre).normal.allFinite());
  EXPECT_NEAR(nearest(centre).normal.norm(), 1.0, 1e-13);
  for (int axis = 0; axis < 3; ++axis) {
    const Nearest at = nearest(centre + 0.1 * Vec3(Vec3::Unit(axis)));
    EXPECT_TRUE(std::isfinite(at.gap) && at.normal.allFinite());
  }
}

/// The source samples `nearest` at the vertices that face the obstacle.
TEST_P(Obstacle, SourceAgrees) {
  std::size_t seen = 0;
  for (int round = 0; round < 10; ++round, renew()) {
    SurfaceWorld world(sphere(centre + 1.5 * vector(random).normalized(), 0.6, 8));
    const auto source = entry.make_source(world.surface, 0, contact::fixed_frame(), shape, 5.0, 0.0);
    std::vector<contact::ContactSample> samples;
    source->query(world.state.view(), samples);
    for (const contact::ContactSample& s : samples) {
      const Nearest at = nearest(position(s.a, world.state));
      EXPECT_NEAR(s.gap, at.gap, 1e-13);
      EXPECT_LT((s.normal - at.normal).norm(), 1e-13);
    }
    seen += samples.size();
  }
  EXPECT_GT(seen, 200u);
}

TEST_P(Obstacle, PictureIsItsSurface) {
  for (int round = 0; round < 5; ++round, renew()) {
    const contact::View view{centre + vector(random), 3.0};
    const contact::ObstaclePicture picture = entry.picture(shape, view);
    const TriMesh& mesh = picture.surface;
    ASSERT_GT(mesh.faces.cols(), 1);
    ASSERT_GE(mesh.faces.minCoeff(), 0);
    ASSERT_LT(mesh.faces.maxCoeff(), mesh.vertices.cols());
    for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i)
      EXPECT_NEAR(nearest(mesh.vertices.col(i)).gap, 0.0, 1e-12) << "vertex " << i;
    for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) {
      const Vec3 a = mesh.vertices.col(mesh.faces(0, f)), b = mesh.vertices.col(mesh.faces(1, f)),
                 c = mesh.vertices.col(mesh.faces(2, f)), area = (b - a).cross(c - a),
                 middle = (a + b + c) / 3.0;
      EXPECT_GT(area.norm(), 0.0);
      // slightly above the face, the shape's normal is the face's
      EXPECT_GT(area.dot(nearest(middle + 0.1 * area.normalized()).normal), 0.5 * area.norm())
          << "face " << f;
    }
    if (picture.ground_m) { EXPECT_NEAR(nearest(Vec3(7.0, -9.0, *picture.ground_m)).gap, 0.0, 1e-12); }
  }
}

INSTANTIATE_TEST_SUITE_P(Registry, Obstacle, testing::ValuesIn(names(contact::obstacle_registry())),
                         [](const auto& test) { return test.param; });

TEST(PlaneObstacle, IsAGroundWhereItLooksUp) {
  ObstacleSpec spec{"floor", "plane", {{"position_m", Vec3(1, 2, -0.5)}}};
  const auto picture = [&] {
    return contact::obstacle_entry(spec).picture(contact::obstacle_shape(spec), {});
  };
  ASSERT_TRUE(picture().ground_m);
  EXPECT_EQ(*picture().ground_m, -0.5);
  spec.shape["normal"] = Vec3(0, 0, -1);
  EXPECT_FALSE(picture().ground_m);
}

TEST(Methods, ThatAreNotThereSayWhatToTake) {
  const auto message = [](const std::string& method) -> std::string {
    try {
      contact::check_method(method, "contact a - b");
    } catch (const Error& e) { return e.what(); }
    return "accepted";
  };
  for (const auto& method : contact::method_registry()) EXPECT_EQ(message(method.name), "accepted");
  const std::string known = " (known: analytic, auto, distance, image)";
  EXPECT_EQ(
      message("vertex"),
      "contact a - b: method = \"vertex\" does not exist; \"analytic\" and \"image\" sample at vertices" +
          known);
  EXPECT_EQ(message("pixel"), "contact a - b: method = \"pixel\" does not exist; use \"image\"" + known);
  EXPECT_EQ(message("gpu"), "contact a - b: method = \"gpu\" has been renamed; use \"image\"" + known);
  EXPECT_EQ(message("spheres"), "contact a - b: method = \"spheres\" is not known" + known);
}

}  // namespace
