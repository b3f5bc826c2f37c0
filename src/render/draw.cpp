#include <algorithm>
#include <cmath>

#include "core/counters.h"
#include "overlay.h"
#include "palpate/core/error.h"
#include "render/scene.h"
#include "shade.h"
#include "ticks.h"

namespace palpate::render {
namespace {

void check(const Surface& surface, std::size_t index) {
  const std::string name = surface.name.empty() ? fmt::format("{}", index) : "\"" + surface.name + "\"";
  if (surface.faces.size() > 0 &&
      (surface.faces.minCoeff() < 0 || surface.faces.maxCoeff() >= surface.points.cols()))
    fail("picture: surface {}: a face refers to point {} of {}", name,
         surface.faces.minCoeff() < 0 ? surface.faces.minCoeff() : surface.faces.maxCoeff(),
         surface.points.cols());
  if (!surface.points.allFinite())
    fail("picture: surface {}: a position is not finite: the simulation has diverged; take a smaller step",
         name);
  if (surface.values.size() != 0 && surface.values.size() != surface.points.cols())
    fail("picture: surface {}: {} values for {} points; give one per point or none", name,
         surface.values.size(), surface.points.cols());
}

void check(const Options& options) {
  if (options.width < 16 || options.height < 16 || options.width > 8192 || options.height > 8192)
    fail("picture: {} x {} pixels; each side must be 16 to 8192", options.width, options.height);
  if (options.supersampling < 1 || options.supersampling > 8)
    fail("picture: supersampling = {} must be 1 to 8", options.supersampling);
}

/// Returns the points of all surfaces, concatenated.
Points all_points(const Scene& scene) {
  Eigen::Index count = 0;
  for (const Surface& s : scene.surfaces) count += s.points.cols();
  Points all(3, count);
  Eigen::Index at = 0;
  for (const Surface& s : scene.surfaces) {
    all.middleCols(at, s.points.cols()) = s.points;
    at += s.points.cols();
  }
  return all;
}

ColourScale scale_of(const Scene& scene) {
  double least = INFINITY, greatest = -INFINITY;
  for (const Surface& s : scene.surfaces)
    for (const double v : s.values)
      if (std::isfinite(v)) least = std::min(least, v), greatest = std::max(greatest, v);
  return settled(scene.scale, least, greatest);
}

}  // namespace

Picture draw(const Scene& scene, const Options& options) {
  check(options);
  for (std::size_t i = 0; i < scene.surfaces.size(); ++i) check(scene.surfaces[i], i);
  const Points points = all_points(scene);
  if (points.cols() == 0) fail("picture: there is nothing to show: no surface has a point");
  if (!options.frame.allFinite()) fail("picture: a point of the camera frame is not finite");
  counters::count("render.picture");

  Staging staging;
  staging.scale = scale_of(scene);
  Eigen::AlignedBox3d box;
  const auto each_point = [&](auto visit) {
    for (const Points* all : {&points, &options.frame})
      for (Eigen::Index i = 0; i < all->cols(); ++i) visit(Vec3(all->col(i)));
  };
  each_point([&](const Vec3& x) { box.extend(x); });
  staging.centre = box.center();
  staging.radius = 1e-9;
  each_point([&](const Vec3& x) { staging.radius = std::max(staging.radius, (x - staging.centre).norm()); });
  if (scene.ground)
    staging.grid_spacing =
        scene.ground->spacing > 0.0 ? scene.ground->spacing : round_up(0.2 * staging.radius);
  const bool with_scale = std::any_of(scene.surfaces.begin(), scene.surfaces.end(),
                                      [](const Surface& s) { return s.values.size() > 0; });
  const double aspect = static_cast<double>(options.width) / options.height;
  staging.camera =
      options.camera
          ? *options.camera
          : framed(options.frame.cols() > 0 ? options.frame : points, options.view, aspect,
                   margins_of(scene, options, with_scale ? std::optional(staging.scale) : std::nullopt));

  const Picture shaded = shade(scene, staging, options);
  return options.annotated ? annotated(shaded, scene, staging.scale, with_scale, staging.grid_spacing)
                           : shaded;
}

}  // namespace palpate::render
