#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <string>

namespace palpate {

/// "cvode-bdf" as the name of a test: GoogleTest takes letters, digits and underscores.
inline std::string registry_test_name(const testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return !std::isalnum(c); }, '_');
  return name;
}

}  // namespace palpate
