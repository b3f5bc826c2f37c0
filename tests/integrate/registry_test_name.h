#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <string>

namespace palpate {

/// Converts "cvode-bdf" to the name of a test: GoogleTest accepts letters, digits and underscores.
inline std::string registry_test_name(const testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return !std::isalnum(c); }, '_');
  return name;
}

}  // namespace palpate
