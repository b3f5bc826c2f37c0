// The file read independently of palpate: through h5py, with the arithmetic of VTK's reader.
#include <gtest/gtest.h>

#include "store/python_check.h"
#include "store/sample_run.h"

namespace {

using python_check::rows_of;

nlohmann::json seen_by_h5py(const std::string& path) {
  return python_check::seen("'" PALPATE_TEST_CHECKER "'", path);
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

class VtkHdf : public python_check::Test {
 protected:
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
