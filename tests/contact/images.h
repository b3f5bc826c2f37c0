#pragma once
#include <gtest/gtest.h>

#include "contact/gpu_device.h"
#include "contact/sources.h"

namespace contact_tests {

inline palpate::contact::ImageOptions image_options(int pixels, double candidate_gap) {
  return {.pixels = pixels, .candidate_gap = candidate_gap};
}

}  // namespace contact_tests
