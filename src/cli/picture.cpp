#include "picture.h"

#include <algorithm>

#include "palpate/core/error.h"
#include "palpate/render/seen.h"

namespace palpate::cli {

void Snapshot::tick(const loop::TickRecord& tick) {
  newest_force_n_ = std::max(newest_force_n_, tick.device.force.norm());
}

void Snapshot::period(loop::World& world, double t) {
  if (shade_ != Shade::kPenetration) consider(world, t);
}

void Snapshot::queried(loop::World& world, double t) {
  if (shade_ == Shade::kPenetration) consider(world, t);
}

void Snapshot::consider(loop::World& world, double t) {
  const double felt = newest_force_n_;
  newest_force_n_ = 0.0;
  if (world.description.tool && felt <= force_n_) return;
  force_n_ = felt;
  instant_ = instant_of(world, t, shade_);
}

void Snapshot::save(const loop::World& world, const std::string& path) const {
  render::Scene scene = scene_of(world, instant_, shade_);
  add_obstacles(scene, world, view_of(scene));
  scene.title = fmt::format("{}, t = {:g} s", world.description.name, instant_.time);
  if (world.description.tool) scene.subtitle = fmt::format("the hand feels {:.3g} N", force_n_);
  render::ViewChoice choice;
  choice.add(scene);
  render::Options options;
  options.view = choice.best(!scene.ground);
  render::save_png(render::draw(scene, options), path);
}

}  // namespace palpate::cli
