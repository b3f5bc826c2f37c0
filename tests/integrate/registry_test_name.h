#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace palpate {

/// "cvode-bdf" as the name of a test: GoogleTest takes letters, digits and underscores.
inline std::string registry_test_name(const testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

}  // namespace palpate
