#pragma once
#include <string>

#include "palpate/loop/world.h"

namespace palpate::cli {

/// The bodies as they are now, shaded by displacement, and the tool: one PNG.  @throws Error where pictures were not compiled in
void take_picture(const loop::World& world, const std::string& path);

}  // namespace palpate::cli
