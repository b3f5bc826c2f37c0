#pragma once
#include <gtest/gtest.h>

#include "palpate/contact/gpu_device.h"
#include "palpate/contact/sources.h"

namespace contact_tests {

inline palpate::contact::ImageOptions image_options(int pixels, double candidate_gap) {
  return {.pixels = pixels, .candidate_gap = candidate_gap};
}

}  // namespace contact_tests
