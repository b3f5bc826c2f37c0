#include "live/live_scene.h"

#include <algorithm>
#include <utility>

#include "live/scene_messages.h"
#include "palpate/core/error.h"
#include "palpate/scene/hands.h"

namespace palpate::live {

std::size_t frame_values(const loop::World& world) {
  const std::size_t hands = scene::hands_of(world.description).size();
  std::size_t out = 7 * (hands + world.bones.size()) + 14 * hands;
  for (const loop::Body& body : world.bodies) out += 3 * static_cast<std::size_t>(body.placed.cols());
  return out;
}

LiveScene::LiveScene(const loop::World& world, const std::string& name_in, std::vector<Slider> sliders_in,
                     HandleMailboxes mailboxes)
    : name(name_in),
      sliders(std::move(sliders_in)),
      hands(scene::hands_of(world.description).size()),
      has_hand(hands > 0),
      frames(frame_values(world)),
      strip(std::min(hands, kMostHands)),
      handles(std::move(mailboxes)),
      moduli(world.bodies.size()) {
  if (hands > kMostHands) fail("{}: has {} hands; palpate touch shows at most {}", name, hands, kMostHands);
  const std::vector<SceneSurface> obstacles = obstacle_surfaces(world);
  description = scene_message(world, name, sliders, obstacles, handles);
  geometry = geometry_message(world, obstacles);
}

}  // namespace palpate::live
