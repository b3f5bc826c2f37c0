#pragma once
#include <string>
#include <vector>

#include "live/byte_writer.h"
#include "live/page_device.h"
#include "live/sliders.h"
#include "palpate/loop/world.h"

/// Messages that describe a scene to its viewers (docs/live.md).
namespace palpate::live {

/// Rigid surface of a scene.
struct SceneSurface {
  std::string name;
  TriMesh surface;
  bool is_bounded = true;
};

/// Returns the obstacles of a scene in world axes, unbounded ones cut to the neighbourhood of the bodies.
std::vector<SceneSurface> obstacle_surfaces(const loop::World& world);

/// Returns the message `scene`.
/// @param name  name by which it was opened  @param sliders  in the order of the page
/// @param obstacles  of obstacle_surfaces()  @param handles  mailboxes of the hands that viewers move
std::string scene_message(const loop::World& world, const std::string& name,
                          const std::vector<Slider>& sliders, const std::vector<SceneSurface>& obstacles,
                          const HandleMailboxes& handles);

/// Returns the message `geometry`.
Bytes geometry_message(const loop::World& world, const std::vector<SceneSurface>& obstacles);

}  // namespace palpate::live
