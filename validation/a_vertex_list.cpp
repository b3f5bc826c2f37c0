#include <algorithm>
#include <cmath>

#include "b_bodies.h"
#include "cases.h"
#include "images.h"
#include "palpate/core/error.h"
#include "palpate/mesh/generators.h"

// Problem: the list of colliding vertices (Galoppo et al. 2007), which contains every vertex of a soft sphere
// inside a rigid one, with its depth along the contact normal n.
//
// Exact answer: the line along n through each vertex is intersected with every triangle of the other sphere
// in double precision; depth = height of the highest crossing - height of the vertex.
//
// Measured: depths, to 1e-5 R, and vertices missed or extra (none accepted). A vertex less deep than the
// height that the border of the overlap gains over one pixel may be in either list.

namespace palpate::validation {
namespace {

constexpr double kR1 = 1.0, kR2 = 0.8, kDistance = 1.5;
constexpr double kLensBottom = 0.4;  // z on the lower sphere [m]: the lens ends at 0.63, a facet is 0.03

struct Pair {
  TriMesh a = mesh::sphere(kR1, 40), b = mesh::sphere(kR2, 33);
  Pair() {
    a.vertices = (Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()).toRotationMatrix() * a.vertices).eval();
    b.vertices = (Eigen::AngleAxisd(1.3, Vec3(2, -1, 1).normalized()).toRotationMatrix() * b.vertices).eval();
    a.vertices.colwise() += Vec3(0.013, -0.021, kDistance);
  }
};

/// Returns the height along n, above `p`, of the highest triangle of `mesh` that faces n; NaN where there is
/// none.
double highest_above(const TriMesh& mesh, const Vec3& p, const Vec3& n) {
  double best = std::nan("");
  const Vec3 u = n.unitOrthogonal(), v = n.cross(u);
  for (const auto& face : mesh.faces.colwise()) {
    if (mesh.vertices.col(face[0]).z() < kLensBottom) continue;
    Eigen::Vector2d c[3];
    double height[3];
    for (int k = 0; k < 3; ++k) {
      const Vec3 d = mesh.vertices.col(face[k]) - p;
      c[k] = {d.dot(u), d.dot(v)};
      height[k] = d.dot(n);
    }
    const auto cross = [](const Eigen::Vector2d& s, const Eigen::Vector2d& t) {
      return s.x() * t.y() - s.y() * t.x();
    };
    const double area = cross(c[1] - c[0], c[2] - c[0]);
    if (!(area > 0.0)) continue;
    const double w0 = cross(c[1], c[2]) / area, w1 = cross(c[2], c[0]) / area, w2 = 1.0 - w0 - w1;
    if (std::min({w0, w1, w2}) < -1e-12) continue;
    const double at = w0 * height[0] + w1 * height[1] + w2 * height[2];
    if (std::isnan(best) || at > best) best = at;
  }
  return best;
}

struct ListError {
  double largest = 0.0;  ///< Largest depth error, divided by R.
  int missed = 0, extra = 0, compared = 0;
};

ListError compare(const Pair& pair, int pixels, const std::string& fault) {
  SurfaceBody body(pair.a);
  contact::ImageOptions options;
  options.pixels = pixels;
  options.candidate_gap = 1e-2;
  const auto source =
      spoiled(contact::make_image_source(body.surface, pair.b, 0, contact::fixed_frame(), options),
              [&](auto& samples) {
                if (fault == "neighbours-depth")
                  for (std::size_t i = 1; i < samples.size(); ++i) samples[i - 1].gap = samples[i].gap;
                if (fault == "lost-samples") {
                  std::size_t i = 0;
                  std::erase_if(samples, [&](const auto&) { return ++i % 50 == 0; });
                }
              });
  std::vector<contact::ContactSample> samples;
  source->query(body.state.view(), samples);
  ListError out;
  if (samples.empty()) return out;
  const Vec3 n = samples.front().normal;
  std::vector<double> found(static_cast<std::size_t>(pair.a.vertices.cols()), std::nan(""));
  for (const auto& s : samples)
    for (int k = 0; k < s.a.count; ++k)
      if (s.a.weight[static_cast<std::size_t>(k)] > 1.0 - 1e-9)
        found[static_cast<std::size_t>(s.a.node[static_cast<std::size_t>(k)])] = -s.gap;
  // At the border of the lens the spheres have the slopes r/h; their slopes add up.
  const double along = (kDistance * kDistance + kR1 * kR1 - kR2 * kR2) / (2.0 * kDistance),
               rim = std::sqrt(kR1 * kR1 - along * along), slope = rim / along + rim / (kDistance - along),
               doubtful = slope * 2.0 * rim / pixels;
  for (Eigen::Index i = 0; i < pair.a.vertices.cols(); ++i) {
    const bool inside = pair.a.vertices.col(i).norm() < kR2;  // Otherwise no facet of b is above it.
    const double exact = inside ? highest_above(pair.b, pair.a.vertices.col(i), n) : std::nan(""),
                 seen = found[static_cast<std::size_t>(i)];
    if (exact > 0.0 && seen > 0.0) {
      ++out.compared;
      if (exact > doubtful) out.largest = std::max(out.largest, std::abs(exact - seen) / kR1);
    } else if (exact > doubtful) {
      ++out.missed;
    } else if (seen > doubtful) {
      ++out.extra;
    }
  }
  return out;
}

std::vector<Measurement> run(const std::string& fault) {
  const Pair pair;
  std::vector<Measurement> out;
  if (images_work()) {
    const ListError list = compare(pair, 256, fault);
    out.push_back({.quantity = "depths of the colliding vertices, largest difference/R",
                   .computed = list.largest,
                   .error = list.compared > 200 ? list.largest : std::nan(""),
                   .bar = 1e-5,
                   .note = fmt::format("{} vertices", list.compared)});
    out.push_back({.quantity = "vertices missed or extra, more than a pixel from the border [count]",
                   .computed = static_cast<double>(list.missed + list.extra),
                   .error = static_cast<double>(list.missed + list.extra),
                   .bar = 0.0,
                   .note = fmt::format("{} missed, {} extra", list.missed, list.extra)});
  }
  say_what_is_skipped(out);
  return out;
}

}  // namespace

ValidationCase vertex_list() {
  return {.name = "vertex-list",
          .section = "A",
          .summary = "the colliding vertices of two spheres and their depths",
          .why = "a missed vertex is a missing spring (line and triangle, in double)",
          .quick = true,
          .run = run,
          .faults = {{"neighbours-depth", "depths of the colliding"}, {"lost-samples", "missed or extra"}}};
}

}  // namespace palpate::validation
