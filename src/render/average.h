#pragma once
#include "render/picture.h"

namespace palpate::render {

/// Averages each square of `samples` x `samples` pixels in linear light (averaging screen values darkens
/// edges).
/// @param rgba  (samples width) x (samples height) pixels, rows from bottom to top as OpenGL returns them
Picture average(const std::vector<std::uint8_t>& rgba, int width, int height, int samples);

}  // namespace palpate::render
