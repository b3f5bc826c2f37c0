#include <algorithm>
#include <array>
#include <cmath>

#include "b_bodies.h"
#include "cases.h"
#include "core/clock.h"
#include "images.h"
#include "palpate/mesh/generators.h"

// Problem: overlap volume of two spheres with centres d apart, d^2 >= |R1^2 - R2^2| (the lens then lies
// between the two equators and is a height field along the line of centres).
//
// Exact answer for the spheres (closed form of the lens):
//     V = pi (R1 + R2 - d)^2 (d^2 + 2 d (R1 + R2) - 3 (R1 - R2)^2) / (12 d).
// Exact answer for the facets: each pair of facing triangles, projected along the line of centres, is
// intersected. The depth is linear on the intersection, so its positive part is a polygon cut by one more
// line, and is integrated exactly.
//
// Measured: the sum of depth x dA over the pixels, a midpoint rule on the facets. Against the facets only the
// pixels contribute an error (order above 2 as RMS over shifts of the grid: midpoint rule, and at the border
// the depth has a kink but no jump). Against the true spheres the inscribed facets contribute it, with order
// 2 (accepted: 1.9 to 2.1).

namespace palpate::validation {
namespace {

using Vec2 = Eigen::Vector2d;
constexpr double kPi = 3.14159265358979323846;
constexpr double kR1 = 1.0, kR2 = 0.8, kDistance = 1.5;

/// Both surfaces. z is along the line of centres; the first sphere (soft) is above. `orientation` rotates the
/// spheres relative to each other and to the axes.
struct Spheres {
  TriMesh upper, lower;
  Spheres(int subdivisions, int orientation)
      : upper(mesh::sphere(kR1, subdivisions)), lower(mesh::sphere(kR2, subdivisions)) {
    const auto rotate = [](TriMesh& mesh, double angle, const Vec3& axis) {
      mesh.vertices = (Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix() * mesh.vertices).eval();
    };
    rotate(upper, 0.4 + 0.9 * orientation, Vec3(1, 2, 3 - orientation));
    rotate(lower, 1.3 - 0.7 * orientation, Vec3(2 + orientation, -1, 1));
    upper.vertices.row(2).array() += kDistance;
  }
};

struct Corner {
  Vec2 p;
  double depth;
};
using Polygon = std::vector<Corner>;

/// Returns the part of a polygon with `value` >= 0. Value and depth are linear, so a cut edge interpolates
/// both.
template <class Value>
Polygon clip(const Polygon& in, Value value) {
  Polygon out;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const Corner &a = in[i], &b = in[(i + 1) % in.size()];
    const double va = value(a), vb = value(b);
    if (va >= 0.0) out.push_back(a);
    if ((va > 0.0 && vb < 0.0) || (va < 0.0 && vb > 0.0)) {
      const double t = va / (va - vb);
      out.push_back({a.p + t * (b.p - a.p), a.depth + t * (b.depth - a.depth)});
    }
  }
  return out;
}

double cross2(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

double integral(const Polygon& polygon) {
  double sum = 0.0;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    sum += 0.5 * std::abs(cross2(polygon[i].p - polygon[0].p, polygon[i + 1].p - polygon[0].p)) *
           (polygon[0].depth + polygon[i].depth + polygon[i + 1].depth) / 3.0;
  return sum;
}

/// Returns z of a triangle's plane at p.
double plane_z(const Vec3* t, const Vec2& p) {
  const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]);
  return t[0].z() - (n.x() * (p.x() - t[0].x()) + n.y() * (p.y() - t[0].y())) / n.z();
}

/// Returns the integral of (z of `below` - z of `above`)+ over the intersection of both projections.
double pair_volume(const Vec3* above, const Vec3* below) {
  Polygon polygon;
  for (int k = 0; k < 3; ++k) {
    const Vec2 p = above[k].head<2>();
    polygon.push_back({p, plane_z(below, p) - above[k].z()});
  }
  for (int k = 0; k < 3 && polygon.size() > 2; ++k) {  // counter-clockwise seen from above
    const Vec2 p = below[k].head<2>(), q = below[(k + 1) % 3].head<2>();
    polygon = clip(polygon, [&](const Corner& c) { return cross2(q - p, c.p - p); });
  }
  polygon = clip(polygon, [](const Corner& c) { return c.depth; });
  return integral(polygon);
}

/// Returns the triangles whose normal has the given sign along z and which reach into the lens.
std::vector<std::array<Vec3, 3>> facing(const TriMesh& mesh, double sign) {
  std::vector<std::array<Vec3, 3>> out;
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) {
    const std::array<Vec3, 3> t = {mesh.vertices.col(mesh.faces(0, f)), mesh.vertices.col(mesh.faces(1, f)),
                                   mesh.vertices.col(mesh.faces(2, f))};
    const double extreme =
        sign > 0 ? std::max({t[0].z(), t[1].z(), t[2].z()}) : std::min({t[0].z(), t[1].z(), t[2].z()});
    const bool reaches = sign > 0 ? extreme > kDistance - kR1 : extreme < kR2;
    if (reaches && sign * (t[1] - t[0]).cross(t[2] - t[0]).z() > 0.0) out.push_back(t);
  }
  return out;
}

double facet_overlap(const Spheres& spheres) {
  const auto above = facing(spheres.upper, -1.0), below = facing(spheres.lower, 1.0);
  double sum = 0.0;
  for (const auto& a : above) {
    const Vec2 low = a[0].head<2>().cwiseMin(a[1].head<2>()).cwiseMin(a[2].head<2>()),
               high = a[0].head<2>().cwiseMax(a[1].head<2>()).cwiseMax(a[2].head<2>());
    for (const auto& b : below) {
      if (((b[0].head<2>().cwiseMin(b[1].head<2>()).cwiseMin(b[2].head<2>()) - high).array() > 0.0).any())
        continue;
      if (((low - b[0].head<2>().cwiseMax(b[1].head<2>()).cwiseMax(b[2].head<2>())).array() > 0.0).any())
        continue;
      sum += pair_volume(a.data(), b.data());
    }
  }
  return sum;
}

/// Returns the sum of depth x dA over the pixels. Faults: areas are measured on the surface instead of
/// projected; separated surfaces count as touching.
/// @param seconds  if given, the time of a second query of the source is added: the cost of a query when its
/// image exists [s]
double sampled_overlap(const Spheres& spheres, int pixels, double shift_u, double shift_v,
                       const std::string& fault, double* seconds = nullptr) {
  SurfaceBody body(spheres.upper);
  contact::ImageOptions options;
  options.pixels = pixels;
  options.candidate_gap = 1e-3;
  options.shift_u = shift_u;
  options.shift_v = shift_v;
  const auto source =
      contact::make_image_source(body.surface, spheres.lower, 0, contact::fixed_frame(), options);
  std::vector<contact::ContactSample> samples = pixels_of(*source, body.state.view());
  if (seconds) {
    const ScopedTimer timer(*seconds);
    samples = pixels_of(*source, body.state.view());
  }
  for (auto& s : samples) {
    if (fault == "gaps-as-depths") s.gap = -std::abs(s.gap);
    if (fault == "skin-area") s.area /= std::max(0.1, s.b.offset.z() / kR2);
  }
  return overlap_volume(samples);
}

std::vector<Measurement> run(const std::string& fault) {
  std::vector<Measurement> out;
  if (!images_work()) {
    say_what_is_skipped(out);
    return out;
  }
  {
    const Spheres spheres(24, 0);
    const double exact = facet_overlap(spheres);
    std::vector<double> h, error, wall_s;
    double last = 0.0;
    for (const int pixels : {64, 128, 256}) {
      double squares = 0.0, seconds = 0.0;
      for (int i = 0; i < kGridShifts; ++i) {
        const GridShift shift = grid_shift(i);
        last = sampled_overlap(spheres, pixels, shift.u, shift.v, fault, &seconds);
        squares += std::pow(last / exact - 1.0, 2) / kGridShifts;
      }
      h.push_back(1.0 / pixels);
      error.push_back(std::sqrt(squares));
      wall_s.push_back(seconds / kGridShifts);
    }
    Measurement m;
    m.quantity = "sum of depth x dA against the facets' overlap at 256 pixels, RMS over 20 shifts [m^3]";
    m.computed = last;
    m.exact = exact;
    m.error = error.back();
    m.bar = 1e-4;
    m.order = validation::fitted_order(h, error);
    m.order_low = 1.9;
    m.order_high = 3.5;
    m.note = "order in pixel size over 64 to 256";
    m.refinement = {"pixel / edge of the image", h, error, wall_s};
    out.push_back(m);
  }
  {
    const double exact = kPi * std::pow(kR1 + kR2 - kDistance, 2) *
                         (kDistance * kDistance + 2 * kDistance * (kR1 + kR2) - 3 * std::pow(kR1 - kR2, 2)) /
                         (12 * kDistance);
    std::vector<double> h, error;
    double mean = 0.0;
    constexpr int kOrientations = 6;
    for (const int subdivisions : {12, 17, 24, 34, 48}) {
      mean = 0.0;
      for (int i = 0; i < kOrientations; ++i)
        mean += sampled_overlap(Spheres(subdivisions, i), 128, 0.0, 0.0, fault) / kOrientations;
      h.push_back(1.0 / subdivisions);
      error.push_back(std::abs(mean / exact - 1.0));
    }
    Measurement m;
    m.quantity = "sum of depth x dA against the true spheres, finest facets, mean of 6 orientations [m^3]";
    m.computed = mean;
    m.exact = exact;
    m.error = error.back();
    m.bar = 5e-3;
    m.order = validation::fitted_order(h, error);
    m.order_low = 1.9;
    m.order_high = 2.1;
    m.note = "order in facet size over 12 to 48 subdivisions of the icosahedron";
    m.refinement = {"facet / edge of the icosahedron", h, error};
    out.push_back(m);
  }
  return out;
}

}  // namespace

ValidationCase overlap_volume() {
  return {"overlap-volume",
          "A",
          "overlap volume of two spheres: pixels against the facets, facets against the spheres",
          "the image only determines which facets face each other, the rest is exact in double (closed form "
          "of the lens)",
          false,
          true,
          run,
          {{"skin-area", "against the"}, {"gaps-as-depths", "against the facets"}}};
}

}  // namespace palpate::validation
