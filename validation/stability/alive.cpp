#include "alive.h"

#include "palpate/core/error.h"

namespace palpate::stability {

std::string does_not_move(const CaseContext& context, scene::Description d, double rtol) {
  if (is_static(context.column)) return {};
  const Vec3 speed(0.003, -0.002, 0.01);
  d.bodies[0].velocity_m_s = speed;
  d.contacts.clear();
  d.obstacles.clear();
  d.duration_s = 0.1;
  double most = 0.0;
  int periods = 0;
  const SceneCourse course = run_scene(context, d, rtol, 1.0, [&](loop::World& world, double t) {
    const Points shift = world.positions(world.bodies[0]) - world.bodies[0].placed;
    if (!(t > 0.0)) return;
    const double off = (shift.colwise() - t * speed).norm() / (t * speed.norm());
    if (!(off <= most)) most = off;  // Keeps a NaN.
    ++periods;
  });
  if (!course.result.ok())
    return fmt::format("released with a velocity, the run ended: {}", course.result.message);
  if (periods < 5 || !(most <= 1e-6))
    return fmt::format("released with a velocity, its error is {:.1e} of the distance after {} periods", most,
                       periods);
  return {};
}

}  // namespace palpate::stability
