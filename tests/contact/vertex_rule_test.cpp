// Samples at vertices, on patches in contact axes: what the image finds is what lines in double precision
// meet.
#include "contact/vertex_rule.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "backends.h"
#include "sheets.h"

using namespace contact_tests;

namespace {

struct Found {
  std::vector<Hit> hits;
  ContactCamera camera;
};

/// Vertices of both sheets, or of a alone.
Found vertices_of(Sheet& a, Sheet& b, DepthBackend backend, double gap, int pixels, DepthReading depths,
                  bool both = true) {
  Found out;
  std::vector<FacePair> pairs;
  std::vector<std::uint32_t> layered;
  pairs = pairs_of(*image_of(backend), a.seen(), b.seen(), gap, pixels, &out.camera, &layered);
  FacePlanes planes_a, planes_b;
  planes_a.start(a.patch);
  planes_b.start(b.patch);
  std::vector<Hit> middles;
  for (const FacePair& pair : pairs) {
    Hit hit;
    hit.pixel = pair.at;
    hit.at.u = out.camera.u(static_cast<int>(pair.at) % out.camera.width);
    hit.at.v = out.camera.v(static_cast<int>(pair.at) / out.camera.width);
    if (facing_at(pair, planes_a, planes_b, hit.at)) middles.push_back(hit);
  }
  ExactLines lines;
  VertexRule rule;
  rule.find({.a = a.patch,
             .b = b.patch,
             .camera = out.camera,
             .planes_a = planes_a,
             .planes_b = planes_b,
             .candidate_gap = gap,
             .lines_only = backend == DepthBackend::kExact,
             .both_sides = both,
             .depths = depths},
            pairs, layered, middles, lines, out.hits);
  return out;
}

/// Height of a sheet over (u, v), by every triangle; NaN: none.
double height(const Sheet& sheet, double u, double v) {
  for (Eigen::Index f = 0; f < sheet.faces.cols(); ++f) {
    const Vec3 p = sheet.vertices.col(sheet.faces(0, f)), q = sheet.vertices.col(sheet.faces(1, f)),
               r = sheet.vertices.col(sheet.faces(2, f));
    if (u < std::min({p.x(), q.x(), r.x()}) || u > std::max({p.x(), q.x(), r.x()})) continue;
    Eigen::Matrix2d edges;
    edges << (q - p).head<2>(), (r - p).head<2>();
    const Eigen::Vector2d at = edges.inverse() * (Eigen::Vector2d(u, v) - p.head<2>());
    if (at.minCoeff() >= -1e-9 && at.sum() <= 1.0 + 1e-9)
      return p.z() + at[0] * (q.z() - p.z()) + at[1] * (r.z() - p.z());
  }
  return std::nan("");
}

/// Error of the depths against all triangles: root mean square over every `stride`-th sample within |u|, |v|
/// < reach.
double depth_error(const Found& found, const Sheet& b, double reach, long* count, std::size_t stride = 1) {
  double sum = 0.0;
  *count = 0;
  for (std::size_t i = 0; i < found.hits.size(); i += stride) {
    const Hit& hit = found.hits[i];
    if (std::max(std::abs(hit.at.u), std::abs(hit.at.v)) > reach) continue;
    const double error = hit.at.gap() - (hit.at.w_a - height(b, hit.at.u, hit.at.v));
    sum += error * error;
    ++*count;
  }
  return std::sqrt(sum / static_cast<double>(*count));
}

}  // namespace

ON_EACH_BACKEND(VertexRules);

// Each vertex of either sheet that has the other sheet opposite, nearer than the gap, is a sample once, with
// the depth that all triangles in double give it; pixels may be larger or smaller than triangles.
TEST_P(VertexRules, FindsEveryVertexAndItsDepth) {
  Sheet a(30, 0.02, -1.0, 1), b(23, 0.0, 1.0, 2);
  constexpr double kGap = 0.03;
  for (const int pixels : {40, 200}) {
    const Found found = vertices_of(a, b, GetParam(), kGap, pixels, DepthReading::kTriangles);
    long seen = 0;
    double worst = 0.0;
    for (const Hit& hit : found.hits) {
      const double exact = height(a, hit.at.u, hit.at.v) - height(b, hit.at.u, hit.at.v);
      ASSERT_FALSE(std::isnan(exact));
      worst = std::max(worst, std::abs(hit.at.gap() - exact));
      EXPECT_GT(hit.area, 0.0);
    }
    for (const Sheet* sheet : {&a, &b})
      for (const auto x : sheet->vertices.colwise()) {
        const bool inside = std::max(std::abs(x.x()), std::abs(x.y())) < 1.0 - 1e-9;
        if (inside && height(a, x.x(), x.y()) - height(b, x.x(), x.y()) < kGap) ++seen;
      }
    long inner = 0;
    for (const Hit& hit : found.hits) inner += std::max(std::abs(hit.at.u), std::abs(hit.at.v)) < 1.0 - 1e-9;
    EXPECT_GT(seen, 700) << pixels;
    EXPECT_EQ(inner, seen);
    EXPECT_LT(worst, 1e-12) << pixels;
  }
}

// Two passes of half the area: where all is in contact, the areas of all samples sum to that of the plane.
TEST_P(VertexRules, AreasSumToThePlane) {
  Sheet a(20, 0.0, -1.0, 1), b(17, 0.3, 1.0, 2);
  for (const bool both : {true, false}) {
    const Found found = vertices_of(a, b, GetParam(), 0.1, 100, DepthReading::kTriangles, both);
    double area = 0.0, of_a = 0.0;
    for (const Hit& hit : found.hits) {
      area += hit.area;
      if (hit.at.weights_a.maxCoeff() == 1.0) of_a += hit.area;
    }
    // the rim's vertices have pixels beyond the last middle
    EXPECT_NEAR(area, 4.0, 0.01);
    EXPECT_NEAR(of_a, both ? 2.0 : 4.0, 0.01);
  }
}

// A depth that is linear in (u, v) is read exactly between four pixels.
TEST_P(VertexRules, InterpolatedDepthsAreExactOfPlanes) {
  Sheet a(20, 0.0, -1.0, 1), b(9, 0.0, 1.0, 2);
  for (auto x : a.vertices.colwise()) x.z() = -0.2 + 0.1 * x.x() - 0.03 * x.y();
  for (auto x : b.vertices.colwise()) x.z() = 0.05 * x.y();
  a.patch.uvw = a.vertices;
  b.patch.uvw = b.vertices;
  const Found found = vertices_of(a, b, GetParam(), 0.01, 64, DepthReading::kInterpolated);
  long count = 0;
  EXPECT_LT(depth_error(found, b, 0.95, &count), 1e-13);
  EXPECT_GT(count, 400);
}

// And of a smooth depth with an error of second order in the pixels: h^2/8 of its curvatures.
TEST_P(VertexRules, InterpolatedDepthsConvergeAtSecondOrder) {
  Sheet a(170, -0.15, -1.0, 1), b(150, 0.15, 1.0, 2);  // triangles smaller than the finest pixels
  std::vector<double> errors;
  for (const int pixels : {17, 33, 65}) {
    const Found found = vertices_of(a, b, GetParam(), 0.01, pixels, DepthReading::kInterpolated, false);
    long count = 0;
    errors.push_back(depth_error(found, b, 0.9, &count, 23));
    EXPECT_GT(count, 900);
  }
  for (std::size_t i = 1; i < errors.size(); ++i) {
    const double order = std::log2(errors[i - 1] / errors[i]);
    EXPECT_GT(order, 1.7) << errors[i];
    EXPECT_LT(order, 2.3) << errors[i];
  }
  // h = 2/16 and 0.1 sin(3 x + s) cos(4 y), twice: the bound is 2 h^2/8 0.1 (9 + 16)
  EXPECT_LT(errors[0], 2.0 * 0.125 * 0.125 / 8.0 * 0.1 * 25.0);
  EXPECT_GT(errors[0], 1e-4);
}

// Of g = c (u^2 + v^2) the chord between two pixels lies above the curve by h^2 g''/12 on average, in either
// direction: c h^2/3 together.
TEST_P(VertexRules, InterpolatedDepthsErrAsChordsDo) {
  constexpr double kCurvature = 0.2;
  Sheet a(170, 0.0, -1.0, 1), b(9, 0.0, 1.0, 2);
  for (auto x : a.vertices.colwise()) x.z() = kCurvature * x.head<2>().squaredNorm() - 0.5;
  b.vertices.row(2).setZero();
  a.patch.uvw = a.vertices;
  b.patch.uvw = b.vertices;
  const Found found = vertices_of(a, b, GetParam(), 0.01, 17, DepthReading::kInterpolated, false);
  double sum = 0.0;
  long count = 0;
  for (const Hit& hit : found.hits) {
    if (std::max(std::abs(hit.at.u), std::abs(hit.at.v)) > 0.8) continue;
    sum += hit.at.gap() - (kCurvature * (hit.at.u * hit.at.u + hit.at.v * hit.at.v) - 0.5);
    ++count;
  }
  const double h = found.camera.pixel;
  EXPECT_GT(count, 15000);
  EXPECT_NEAR(sum / static_cast<double>(count), kCurvature * h * h / 3.0, 0.05 * kCurvature * h * h / 3.0);
}
