#pragma once
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "palpate/contact/gpu_available.h"
#include "palpate/contact/sources.h"

/// Tests of contact in image space run on every backend of this build.
namespace contact_tests {

/// That of the test under way.
inline palpate::contact::DepthBackend& backend() {
  static auto now = palpate::contact::DepthBackend::kCpu;
  return now;
}

/// This program has opened OpenGL.
bool& gpu_was_used();

inline palpate::contact::ImageOptions image_options(int pixels, double candidate_gap) {
  palpate::contact::ImageOptions out;
  out.backend = backend();
  out.pixels = pixels;
  out.candidate_gap = candidate_gap;
  return out;
}

class OnEachBackend : public ::testing::TestWithParam<palpate::contact::DepthBackend> {
 protected:
  void SetUp() override {
    backend() = GetParam();
    gpu_was_used() = gpu_was_used() || GetParam() == palpate::contact::DepthBackend::kGpu;
  }
};

inline std::vector<palpate::contact::DepthBackend> backends() {
  using palpate::contact::DepthBackend;
  std::vector<DepthBackend> out = {DepthBackend::kCpu, DepthBackend::kExact};
  if (palpate::contact::gpu_available()) out.push_back(DepthBackend::kGpu);
  return out;
}

inline std::string backend_test_name(const ::testing::TestParamInfo<palpate::contact::DepthBackend>& info) {
  return std::string(palpate::contact::backend_name(info.param));
}

}  // namespace contact_tests

#define ON_EACH_BACKEND(Suite)                                                        \
  class Suite : public contact_tests::OnEachBackend {};                               \
  INSTANTIATE_TEST_SUITE_P(On, Suite, ::testing::ValuesIn(contact_tests::backends()), \
                           contact_tests::backend_test_name)
