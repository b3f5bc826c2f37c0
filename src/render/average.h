#pragma once
#include "palpate/render/picture.h"

namespace palpate::render {

/// The mean of each square of `samples` x `samples` pixels,
/// taken in linear light (a mean of screen values darkens edges).
/// @param rgba  (samples width) x (samples height) pixels, rows from below as OpenGL gives them
Picture average(const std::vector<std::uint8_t>& rgba, int width, int height, int samples);

}  // namespace palpate::render
