#include "store/xdmf.h"

#include "palpate/core/error.h"
#include "store/python_check.h"
#include "store/sample_run.h"

namespace {

using python_check::rows_of;
using Rows = std::vector<std::vector<int>>;

class Xdmf : public python_check::Test {
 protected:
  /// A run of `steps` steps in a file with room for `expected`.
  std::string written(int expected, int steps) {
    const std::string path = folder_ / "run.vtkhdf";
    palpate::store::RunFile file(path, sample_run::parts(), sample_run::info(expected));
    for (int s = 0; s < steps; ++s) sample_run::append(file, s);
    return path;
  }

  sample_run::Folder folder_;
};

void expect_grid(const nlohmann::json& grid, const palpate::store::RunPart& part, int step, int first) {
  const Eigen::Index n = part.reference.cols();
  EXPECT_EQ(grid["name"], part.name);
  EXPECT_EQ(grid["points"], rows_of(sample_run::points(step).middleCols(first, n)));
  EXPECT_EQ(grid["displacement"], rows_of(sample_run::displacement(step).middleCols(first, n)));
  EXPECT_EQ(grid["velocity"], rows_of(sample_run::velocity(step).middleCols(first, n)));
  const palpate::VecX stress = sample_run::stress(step).segment(first, n);
  EXPECT_EQ(grid["stress"], std::vector<double>(stress.begin(), stress.end()));
}

void expect_sample(const std::string& path, int steps) {
  const nlohmann::json seen = python_check::foreign("xdmf", path);
  ASSERT_EQ(seen.size(), static_cast<std::size_t>(steps));
  for (int s = 0; s < steps; ++s) {
    const nlohmann::json& step = seen[static_cast<std::size_t>(s)];
    EXPECT_EQ(step["time"], sample_run::time(s));
    ASSERT_EQ(step["grids"].size(), 2u);
    expect_grid(step["grids"][0], sample_run::parts()[0], s, 0);
    expect_grid(step["grids"][1], sample_run::parts()[1], s, 5);
    EXPECT_EQ(step["grids"][0]["kind"], "Tetrahedron");
    EXPECT_EQ(step["grids"][0]["cells"], (Rows{{0, 1, 2, 3}, {1, 2, 3, 4}}));
    EXPECT_EQ(step["grids"][0]["body"], (std::vector<int>{0, 0}));
    EXPECT_EQ(step["grids"][1]["kind"], "Triangle");
    EXPECT_EQ(step["grids"][1]["cells"], (Rows{{0, 1, 2}})) << "counted in the part's own points";
    EXPECT_EQ(step["grids"][1]["body"], (std::vector<int>{1}));
  }
}

TEST_F(Xdmf, ShowsWhatTheRunHolds) {
  EXPECT_EQ(palpate::store::xdmf_path(written(4, 4)), folder_ / "run.xdmf");
  expect_sample(folder_ / "run.xdmf", 4);
}

TEST_F(Xdmf, OfARunThatWasStoppedOrWentOnLonger) {
  written(50, 3);
  expect_sample(folder_ / "run.xdmf", 3);
  written(1, 5);
  expect_sample(folder_ / "run.xdmf", 5);
}

TEST_F(Xdmf, MovesTogetherWithItsRun) {
  written(2, 2);
  std::filesystem::create_directory(folder_ / "elsewhere");
  for (const char* name : {"run.vtkhdf", "run.xdmf"})
    std::filesystem::rename(folder_ / name, folder_ / (std::string("elsewhere/") + name));
  expect_sample(folder_ / "elsewhere/run.xdmf", 2);
}

TEST_F(Xdmf, NoneOfAnEarlierRunIsLeft) {
  written(2, 2);
  ASSERT_TRUE(std::filesystem::exists(folder_ / "run.xdmf"));
  palpate::store::RunFile next(folder_ / "run.vtkhdf", sample_run::parts(), sample_run::info(2));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run.xdmf")) << "it would show the new run's points";
  next.close();
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run.xdmf")) << "there is no step to show";
}

TEST_F(Xdmf, NamesMayHoldWhatXmlDoesNot) {
  auto parts = sample_run::parts();
  parts[0].name = "a<b>&\"c\"";
  {
    palpate::store::RunFile file(folder_ / "run.vtkhdf", parts, sample_run::info(1));
    sample_run::append(file, 0);
  }
  const nlohmann::json seen = python_check::foreign("xdmf", folder_ / "run.xdmf");
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_EQ(seen[0]["grids"][0]["name"], parts[0].name);
}

/// If the sidecar cannot be written, the run file is complete all the same.
TEST_F(Xdmf, RefusalIsAnErrorBehindTheRun) {
  std::filesystem::create_directories(folder_ / "run.xdmf/in the way");
  const std::string path = folder_ / "run.vtkhdf";
  palpate::store::RunFile file(path, sample_run::parts(), sample_run::info(1));
  sample_run::append(file, 0);
  EXPECT_THROW(file.close(), palpate::Error);
  EXPECT_EQ(palpate::store::RunReader(path).points(0), sample_run::points(0));
}

}  // namespace
