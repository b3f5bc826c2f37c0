#pragma once
#include "palpate/loop/world.h"

namespace palpate::cli {

/// Prints the bounding boxes of bodies, tools and bounded obstacles.
void print_boxes(const loop::World& world);

/// Prints the gaps between the objects of a scene at its start, after one line per tool that
/// start = "touching" moved.
void print_clearances(const loop::World& world, bool all);

}  // namespace palpate::cli
