#include <algorithm>
#include <cmath>

#include "a_reference_image.h"
#include "b_bodies.h"
#include "cases.h"
#include "image_backends.h"
#include "palpate/core/error.h"
#include "palpate/mesh/generators.h"

// A soft sphere on a comb: a rigid block with upright teeth, with steep ones (a slope of 10), and with teeth
// that are wider at their tops than at their roots, as gears have them undercut.  Seen along the normal the
// first have walls that an image shows in no pixel, the second walls that it shows in a few, and the third
// layers: under a top's rim lies the ground.  The depth is that of the true surfaces along n: to the highest
// of them under each pixel's middle.
//
// The images must find such pixels themselves and leave them to exact lines.

namespace palpate::validation {
namespace {

constexpr double kRadius = 1.0, kDepth = 0.25, kPitch = 0.2, kDeep = 0.1;

/// Teeth along y, at x = -1.2 .. 1.2; `slope`: by how much their roots are narrower on either side [m].
TriMesh comb(double slope) {
  std::vector<Eigen::Vector2d> profile;  // x and z, from left to right
  for (double x = -1.2; x < 1.2 - 1e-9; x += kPitch) {
    const double left = x + 0.27 * kPitch, right = x + 0.73 * kPitch;
    profile.insert(profile.end(),
                   {{x, -kDeep}, {left + slope, -kDeep}, {left, 0.0}, {right, 0.0}, {right - slope, -kDeep}});
  }
  profile.emplace_back(1.2, -kDeep);
  const auto n = static_cast<int>(profile.size());
  TriMesh mesh;
  mesh.vertices.resize(3, 4 * n);
  for (int i = 0; i < n; ++i)
    for (int side = 0; side < 2; ++side) {
      const double y = side == 0 ? -1.2 : 1.2;
      const Eigen::Vector2d p = profile[static_cast<std::size_t>(i)];
      mesh.vertices.col(2 * i + side) = Vec3(p.x(), y, p.y());
      mesh.vertices.col(2 * (n + i) + side) = Vec3(2.4 * i / (n - 1) - 1.2, y, -0.6);  // the bottom
    }
  std::vector<Eigen::Vector3i> faces;
  const auto quad = [&](int a, int b, int c, int d) {
    faces.emplace_back(a, b, c);
    faces.emplace_back(a, c, d);
  };
  const auto top = [&](int i, int side) { return 2 * i + side; };
  const auto under = [&](int i, int side) { return 2 * (n + i) + side; };
  for (int i = 0; i + 1 < n; ++i) {
    quad(top(i, 0), top(i + 1, 0), top(i + 1, 1), top(i, 1));
    quad(under(i, 1), under(i + 1, 1), under(i + 1, 0), under(i, 0));
    quad(under(i, 0), under(i + 1, 0), top(i + 1, 0), top(i, 0));
    quad(top(i, 1), top(i + 1, 1), under(i + 1, 1), under(i, 1));
  }
  quad(under(0, 1), under(0, 0), top(0, 0), top(0, 1));
  quad(under(n - 1, 0), under(n - 1, 1), top(n - 1, 1), top(n - 1, 0));
  mesh.faces.resize(3, static_cast<Eigen::Index>(faces.size()));
  for (std::size_t f = 0; f < faces.size(); ++f) mesh.faces.col(static_cast<Eigen::Index>(f)) = faces[f];
  return mesh;
}

void measure(double slope, const std::string& fault, std::vector<Measurement>& out) {
  TriMesh ball = mesh::sphere(kRadius, 24);
  ball.vertices =
      (Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()).toRotationMatrix() * ball.vertices).eval();
  ball.vertices.colwise() += Vec3(0.013, -0.021, kRadius - kDepth);
  const TriMesh teeth = comb(slope);
  for (const contact::DepthBackend backend : image_backends(fault)) {
    SurfaceBody body(ball);
    contact::ImageOptions options;
    options.backend = backend;
    options.candidate_gap = 1e-3;
    auto images = contact::make_image_source(body.surface, teeth, 0, contact::fixed_frame(), options);
    const contact::QueryStages& stages = *images->stages();
    const auto source = spoiled(std::move(images), [&](auto& all) {
      // what lies under a layer, or beside a wall, in place of the top
      if (fault == "ground-for-top")
        for (std::size_t i = 0; i < all.size(); i += 500) all[i].gap += kDeep;
      if (fault == "walls-lost") {
        std::size_t i = 0;
        std::erase_if(all, [&](const auto&) { return ++i % 500 == 0; });
      }
    });
    std::vector<contact::ContactSample> samples;
    source->query(body.state.view(), samples);
    const FieldError field = compare_fields(samples, ball, teeth);
    const bool detected = slope == 0.0 || backend == contact::DepthBackend::kExact || stages.lines > 0;
    const std::string name = fmt::format("{} teeth, {}",
                                         slope > 0.0   ? "undercut"
                                         : slope < 0.0 ? "steep"
                                                       : "upright",
                                         contact::backend_name(backend));
    out.push_back(
        {.quantity = name + ": depth field against the surfaces, largest difference/R",
         .computed = field.inside / kRadius,
         .error = field.compared > 5000 && detected ? field.inside / kRadius : std::nan(""),
         .bar = 1e-6,
         .note = fmt::format("{} pixels, {} of them by exact lines", field.compared, stages.lines)});
    out.push_back({.quantity = name + ": pixels missed or extra, more than one from a silhouette [count]",
                   .computed = static_cast<double>(field.missed + field.extra),
                   .error = static_cast<double>(field.missed + field.extra),
                   .bar = 0.0,
                   .note = fmt::format("{} missed, {} extra", field.missed, field.extra)});
  }
}

std::vector<Measurement> run(const std::string& fault) {
  std::vector<Measurement> out;
  for (const double slope : {0.0, -0.05 * kPitch, 0.15 * kPitch}) measure(slope, fault, out);
  say_what_is_skipped(out);
  return out;
}

}  // namespace

ValidationCase walls() {
  return {.name = "walls",
          .section = "A",
          .summary = "depths of a sphere on a comb of upright, steep and undercut teeth",
          .why =
              "an image shows one layer and no wall; what it cannot show must be found and asked of exact "
              "lines, or gears pass through each other (line and triangle, in double)",
          .quick = true,
          .run = run,
          .faults = {{"ground-for-top", "depth field"}, {"walls-lost", "missed or extra"}}};
}

}  // namespace palpate::validation
