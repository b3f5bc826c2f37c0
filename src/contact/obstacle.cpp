#include "palpate/contact/obstacle.h"

namespace palpate::contact {

/// One line per obstacle: NAME_obstacle() of NAME.cpp.
#define PALPATE_OBSTACLES(OBSTACLE) \
  OBSTACLE(plane)                   \
  OBSTACLE(sphere)                  \
  OBSTACLE(box)                     \
  OBSTACLE(cylinder)

#define PALPATE_OBSTACLE(name) const ObstacleEntry& name##_obstacle();
PALPATE_OBSTACLES(PALPATE_OBSTACLE)
#undef PALPATE_OBSTACLE

const std::vector<ObstacleEntry>& obstacle_registry() {
#define PALPATE_OBSTACLE(name) name##_obstacle(),
  static const std::vector<ObstacleEntry> registry = {PALPATE_OBSTACLES(PALPATE_OBSTACLE)};
#undef PALPATE_OBSTACLE
  return registry;
}

const ObstacleEntry& obstacle_entry(const ObstacleSpec& spec) {
  return find(obstacle_registry(), spec.type, fmt::format("type of obstacle \"{}\":", spec.name));
}

Settings obstacle_shape(const ObstacleSpec& spec) {
  return complete(obstacle_entry(spec).keys, spec.shape,
                  fmt::format("obstacle \"{}\", type = \"{}\"", spec.name, spec.type));
}

}  // namespace palpate::contact
