#pragma once
#include <gtest/gtest.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "palpate/core/types.h"

/// Reads files independently of palpate: through h5py and numpy.
namespace python_check {

struct Output {
  int status = -1;
  std::string text;
};

inline Output run(const std::string& command) {
  Output out;
  std::FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  for (char block[4096]; const std::size_t n = std::fread(block, 1, sizeof block, pipe);)
    out.text.append(block, n);
  out.status = pclose(pipe);
  return out;
}

/// Returns the script's output for the file.
inline nlohmann::json seen(const std::string& script_and_options, const std::string& path) {
  const Output out = run("'" PALPATE_TEST_PYTHON "' -B " + script_and_options + " '" + path + "'");
  EXPECT_EQ(out.status, 0) << out.text;
  return out.status == 0 ? nlohmann::json::parse(out.text) : nlohmann::json();
}

/// Returns foreign.py's output for the file.
inline nlohmann::json foreign(const std::string& kind, const std::string& path) {
  return seen("'" PALPATE_TEST_FOREIGN "' " + kind, path);
}

inline std::vector<std::vector<double>> rows_of(const palpate::Points& points) {
  std::vector<std::vector<double>> rows;
  for (const auto& column : points.colwise()) rows.push_back({column[0], column[1], column[2]});
  return rows;
}

inline bool missing_h5py() { return run("'" PALPATE_TEST_PYTHON "' -c 'import h5py'").status != 0; }

/// Test cases that are skipped if Debian's python3-h5py is missing.
class Test : public testing::Test {
 protected:
  void SetUp() override {
    if (missing_h5py())
      GTEST_SKIP() << "python3-h5py is missing: apt-get install python3-h5py (it is in .packages)";
  }
};

}  // namespace python_check
