#include "export_animation.h"

#include <algorithm>

#include "cli/stop.h"
#include "core/rigid_fit.h"
#include "palpate/core/error.h"
#include "store/glb.h"
#include "store/provenance.h"

namespace palpate::cli {
namespace {

/// Returns at most `most` of the steps, evenly spaced.
std::vector<int> thinned(const std::vector<int>& steps, std::size_t most) {
  if (steps.size() <= most) return steps;
  std::vector<int> out;
  for (std::size_t i = 0; i < most; ++i) out.push_back(steps[i * (steps.size() - 1) / (most - 1)]);
  return out;
}

std::size_t most_states(const std::vector<store::SurfaceState>& first, const RecordedSurfaces& surfaces) {
  std::size_t bytes = 0;  // per state
  for (std::size_t i = 0; i < first.size(); ++i)
    if (!surfaces.rigid(i)) bytes += static_cast<std::size_t>(first[i].points.size()) * sizeof(float);
  const std::size_t fit = bytes > 0 ? kMostPositionBytes / bytes : kMostKeyframes;
  return std::clamp<std::size_t>(fit, 2, kMostKeyframes);
}

/// Returns the points relative to their mean, the origin of the local axes of the surface.
Points centred(const Points& points) { return points.colwise() - points.rowwise().mean(); }

}  // namespace

Animation animated(const store::RunReader& run, const RecordedSurfaces& surfaces,
                   const std::vector<int>& steps) {
  const std::vector<store::SurfaceState> first = surfaces.at(steps.front(), 0.0);
  if (first.empty()) fail("the run has no surface to show");
  Animation out{{}, thinned(steps, most_states(first, surfaces))};
  std::vector<store::MovingSurface> moving(first.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    moving[i].name = first[i].name;
    moving[i].faces = first[i].faces;
    moving[i].colour = surfaces.colour(i);
    if (!surfaces.rigid(i)) continue;
    moving[i].opacity = 0.6;  // the dent lies under the tool
    moving[i].points = {centred(first[i].points)};
  }
  std::vector<double> times;
  for (const int step : out.steps) {
    if (stop_flag().load()) return out;
    times.push_back(run.times_s()[static_cast<std::size_t>(step)]);
    std::vector<store::SurfaceState> now = surfaces.at(step, 0.0);
    for (std::size_t i = 0; i < now.size(); ++i)
      if (surfaces.rigid(i))
        moving[i].poses.push_back(rigid_fit(moving[i].points[0], now[i].points));
      else
        moving[i].points.push_back(std::move(now[i].points));
  }
  out.glb = store::glb_of(moving, times, run.info().scene_name, "palpate " + store::provenance().version);
  return out;
}

}  // namespace palpate::cli
