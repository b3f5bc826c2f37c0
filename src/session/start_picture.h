#pragma once
#include <string>

#include "palpate/loop/world.h"

namespace palpate::session {

/// Checks at the start that a picture can be drawn.
/// @throws Error if not, or if the name does not end in .png
void check_start_picture(const std::string& path);

/// Draws the scene at its start into a PNG file: all objects, the axes of the world, the bounding box of each
/// body with its sizes, and the nodes that attachments hold, drive or carry.
/// @throws Error if the file cannot be written
void draw_start(loop::World& world, const std::string& path);

}  // namespace palpate::session
