// Samples at vertices, on patches in contact axes: the image's result equals the intersection of lines in
// double precision.
#include "contact/vertex_rule.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "images.h"
#include "sheets.h"

using namespace contact_tests;

namespace {

struct Found {
  std::vector<Hit> hits;
  ContactCamera camera;
};

/// Samples at the vertices of both sheets, or of a only.
Found vertices_of(Sheet& a, Sheet& b, double gap, int pixels, bool both = true) {
  Found out;
  const std::vector<FacePair> pairs =
      pairs_of(*make_depth_image(), a.seen(), b.seen(), gap, pixels, &out.camera);
  FacePlanes planes_a, planes_b;
  planes_a.start(a.patch);
  planes_b.start(b.patch);
  VertexRule rule;
  rule.find({.a = a.patch,
             .b = b.patch,
             .camera = out.camera,
             .planes_a = planes_a,
             .planes_b = planes_b,
             .candidate_gap = gap,
             .both_sides = both},
            pairs, out.hits);
  return out;
}

/// Height of a sheet over (u, v), by every triangle; NaN if there is none.
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

}  // namespace

// Each vertex of either sheet that has the other sheet opposite, nearer than the gap, gives one sample; with
// pixels of the size of the triangles one in fifty may be missed. Its depth is that of all triangles in
// double precision if the centre of some pixel around the vertex lies in the opposite triangle; else a
// neighbour's plane is extended by less than a pixel, with a slope that differs by less than two.
TEST(VertexRules, FindsEveryVertexAndItsDepth) {
  Sheet a(30, 0.02, -1.0, 1), b(23, 0.0, 1.0, 2);
  constexpr double kGap = 0.03;
  for (const int pixels : {40, 400}) {
    const Found found = vertices_of(a, b, kGap, pixels);
    long seen = 0;
    double worst = 0.0;
    std::size_t extended = 0;
    for (const Hit& hit : found.hits) {
      const double exact = height(a, hit.at.u, hit.at.v) - height(b, hit.at.u, hit.at.v);
      ASSERT_FALSE(std::isnan(exact));
      worst = std::max(worst, std::abs(hit.at.gap() - exact));
      extended += std::abs(hit.at.gap() - exact) > 1e-12;
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
    EXPECT_LE(std::abs(inner - seen), pixels == 40 ? seen / 50 : 0) << pixels;
    EXPECT_LT(worst, 2.0 * found.camera.pixel) << pixels;
    EXPECT_LT(extended, (pixels == 40 ? 0.3 : 0.01) * static_cast<double>(found.hits.size())) << pixels;
  }
}

// Two passes with half the area each: where everything is in contact, the areas of all samples sum to the
// area of the plane.
TEST(VertexRules, AreasSumToThePlane) {
  Sheet a(20, 0.0, -1.0, 1), b(17, 0.3, 1.0, 2);
  for (const bool both : {true, false}) {
    const Found found = vertices_of(a, b, 0.1, 100, both);
    double area = 0.0, of_a = 0.0;
    for (const Hit& hit : found.hits) {
      area += hit.area;
      if (hit.at.weights_a.maxCoeff() == 1.0) of_a += hit.area;
    }
    // vertices on the rim have pixels beyond the last pixel centre
    EXPECT_NEAR(area, 4.0, 0.01);
    EXPECT_NEAR(of_a, both ? 2.0 : 4.0, 0.01);
  }
}

// A sheet hidden behind another sheet of the same body has no samples.
TEST(VertexRules, WhatIsHiddenHasNone) {
  Sheet front(20, 0.0, -1.0, 1), b(17, 0.05, 1.0, 2);
  const Eigen::Index vertices = front.vertices.cols(), faces = front.faces.cols();
  Sheet both = front;
  both.vertices.resize(3, 2 * vertices);
  both.vertices << front.vertices, front.vertices.colwise() + Vec3(0.0, 0.0, 0.3);
  both.faces.resize(3, 2 * faces);
  both.faces << front.faces, front.faces.array() + static_cast<int>(vertices);
  both.patch.uvw = both.vertices;
  const Found alone = vertices_of(front, b, 1.0, 100, false), with = vertices_of(both, b, 1.0, 100, false);
  EXPECT_GT(alone.hits.size(), 300u);
  EXPECT_EQ(with.hits.size(), alone.hits.size());
  for (const Hit& hit : with.hits) EXPECT_LT(hit.face_a, faces);
}
