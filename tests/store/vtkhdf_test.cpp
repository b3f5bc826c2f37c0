// The file as a program that knows nothing of palpate sees it: through h5py, with the arithmetic of VTK's
// reader.
#include <gtest/gtest.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "store/sample_run.h"

namespace {

struct Output {
  int status = -1;
  std::string text;
};

Output run(const std::string& command) {
  Output out;
  std::FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  for (char block[4096]; const std::size_t n = std::fread(block, 1, sizeof block, pipe);)
    out.text.append(block, n);
  out.status = pclose(pipe);
  return out;
}

nlohmann::json seen_by_h5py(const std::string& path) {
  const Output out = run(std::string("'" PALPATE_TEST_PYTHON "' '" PALPATE_TEST_CHECKER "' '") + path + "'");
  EXPECT_EQ(out.status, 0) << out.text;
  return out.status == 0 ? nlohmann::json::parse(out.text) : nlohmann::json();
}

std::vector<std::vector<double>> rows_of(const palpate::Points& points) {
  std::vector<std::vector<double>> rows;
  for (const auto& column : points.colwise()) rows.push_back({column[0], column[1], column[2]});
  return rows;
}

void expect_sample(const nlohmann::json& file, int steps) {
  ASSERT_EQ(file.at("steps").size(), static_cast<std::size_t>(steps));
  for (int s = 0; s < steps; ++s) {
    const nlohmann::json& step = file["steps"][static_cast<std::size_t>(s)];
    EXPECT_EQ(step["time"], sample_run::time(s));
    EXPECT_EQ(step["points"], rows_of(sample_run::points(s)));
    EXPECT_EQ(step["displacement"], rows_of(sample_run::displacement(s)));
    EXPECT_EQ(step["velocity"], rows_of(sample_run::velocity(s)));
    const palpate::VecX stress = sample_run::stress(s);
    EXPECT_EQ(step["stress"], std::vector<double>(stress.begin(), stress.end()));
    EXPECT_EQ(step["offsets"], (std::vector<int>{0, 4, 8, 11})) << "two tetrahedra and a triangle";
    EXPECT_EQ(step["connectivity"], (std::vector<int>{0, 1, 2, 3, 1, 2, 3, 4, 5, 6, 7}));
    EXPECT_EQ(step["types"], (std::vector<int>{10, 10, 5})) << "VTK_TETRA, VTK_TETRA, VTK_TRIANGLE";
    EXPECT_EQ(step["body"], (std::vector<int>{0, 0, 1}));
  }
}

class VtkHdf : public testing::Test {
 protected:
  void SetUp() override {
    if (run("'" PALPATE_TEST_PYTHON "' -c 'import h5py'").status != 0)
      GTEST_SKIP() << "python3-h5py is missing: apt-get install python3-h5py (it is in .packages)";
  }
  sample_run::Folder folder_;
};

TEST_F(VtkHdf, IsReadAsVtkReadsIt) {
  const std::string path = folder_ / "run.vtkhdf";
  {
    palpate::store::RunFile file(path, sample_run::parts(), sample_run::info(3));
    for (int s = 0; s < 3; ++s) sample_run::append(file, s);
  }
  const nlohmann::json seen = seen_by_h5py(path);
  expect_sample(seen, 3);
  EXPECT_EQ(seen["units"], (nlohmann::json{{"displacement", "m"}, {"velocity", "m/s"}, {"stress", "Pa"}}));
  EXPECT_EQ(seen["scene"], sample_run::info(3).scene_source);
}

TEST_F(VtkHdf, IsValidBeforeItIsClosed) {
  const std::string path = folder_ / "run.vtkhdf", copy = folder_ / "copy.vtkhdf";
  palpate::store::RunFile file(path, sample_run::parts(), sample_run::info(10));
  for (int s = 0; s < 2; ++s) sample_run::append(file, s);
  std::filesystem::copy_file(path, copy);
  expect_sample(seen_by_h5py(copy), 2);
}

}  // namespace
