#include "session/peak_force_picture.h"

#include <algorithm>

#include "core/time_text.h"
#include "palpate/core/error.h"
#include "render/seen.h"
#include "session/scene_view.h"
#include "session/shade_values.h"
#include "session/snapshot_scene.h"

namespace palpate::session {

void PeakForcePicture::tick(const loop::TickRecord& tick) {
  const double force_n = tick.device.force.norm();
  if (tick.handle_valid) handle_ = tick.handle;
  if (force_n > newest_force_n_) newest_force_n_ = force_n, newest_force_s_ = tick.time;
}

void PeakForcePicture::period(loop::World& world, double t) {
  if (shade_ != Shade::kPenetration) consider(world, t);
}

void PeakForcePicture::queried(loop::World& world, double t) {
  if (shade_ == Shade::kPenetration) consider(world, t);
}

void PeakForcePicture::consider(loop::World& world, double t) {
  const double felt = newest_force_n_;
  newest_force_n_ = 0.0;
  if (world.description.tool) {
    if (felt <= force_n_) return;
    force_n_ = felt;
    force_s_ = newest_force_s_;
    snapshot_ = snapshot_of(world, t, shade_);
    snapshot_.handle = handle_;
    return;
  }
  WorldSnapshot now = snapshot_of(world, t, shade_);
  const double value = largest_value(world, now, shade_);
  if (value <= value_) return;
  value_ = value;
  snapshot_ = std::move(now);
}

void PeakForcePicture::save(const loop::World& world, const std::string& path, double largest) const {
  render::Scene scene = scene_of(world, snapshot_, shade_, largest);
  add_obstacles(scene, world, view_of(scene));
  scene.title = fmt::format("{}, t = {} s", world.description.name, time_text(snapshot_.time));
  if (world.description.tool)
    scene.subtitle =
        fmt::format("largest force on the hand {:.3g} N, at {} s", force_n_, time_text(force_s_));
  render::ViewChoice choice;
  choice.add(scene);
  render::Options options;
  options.view = scene_view(world.description.view, choice.best(!scene.ground));
  render::save_png(render::draw(scene, options), path);
}

}  // namespace palpate::session
