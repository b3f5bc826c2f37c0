#include "palpate/store/run_file.h"

#include <gtest/gtest.h>

#include <fstream>

#include "core/counters.h"
#include "palpate/core/error.h"
#include "store/sample_run.h"

using namespace palpate;
using store::RunFile;
using store::RunReader;

namespace {

void expect_steps(const std::string& path, int steps) {
  const RunReader run(path);
  ASSERT_EQ(run.steps(), steps);
  ASSERT_EQ(run.point_count(), sample_run::kPoints);
  for (int s = 0; s < steps; ++s) {
    EXPECT_EQ(run.times_s()[static_cast<std::size_t>(s)], sample_run::time(s));
    EXPECT_EQ(run.points(s), sample_run::points(s)) << "step " << s;
    EXPECT_EQ(run.displacement(s), sample_run::displacement(s));
    EXPECT_EQ(run.velocity(s), sample_run::velocity(s));
    EXPECT_EQ(run.stress(s), sample_run::stress(s));
  }
}

TEST(RunFile, ReadsBackWhatWasWritten) {
  const sample_run::Folder folder;
  const std::string path = folder / "run.vtkhdf";
  {
    RunFile file(path, sample_run::parts(), sample_run::info(4));
    for (int s = 0; s < 4; ++s) sample_run::append(file, s);
    EXPECT_EQ(file.steps(), 4);
    file.close();
  }
  expect_steps(path, 4);
  const RunReader run(path);
  EXPECT_EQ(run.info().scene_source, sample_run::info(4).scene_source);
  EXPECT_EQ(run.info().scene_name, "sample");
  EXPECT_EQ(run.info().version, "0.0.0 test");
  ASSERT_EQ(run.parts().size(), 2u);
  EXPECT_EQ(run.parts()[0].name, "ball");
  EXPECT_EQ(run.parts()[0].tets, sample_run::parts()[0].tets);
  EXPECT_EQ(run.parts()[1].faces, sample_run::parts()[1].faces);
  EXPECT_EQ(run.first_point(1), 5);
}

TEST(RunFile, FewerAndMoreStepsThanExpected) {
  const sample_run::Folder folder;
  for (const auto& [expected, steps] : {std::pair{50, 3}, {2, 9}, {1, 1}, {0, 2}, {5, 0}}) {
    const std::string path = folder / fmt::format("{}-{}.vtkhdf", expected, steps);
    {
      RunFile file(path, sample_run::parts(), sample_run::info(expected));
      for (int s = 0; s < steps; ++s) sample_run::append(file, s);
    }
    expect_steps(path, steps);
  }
}

TEST(RunFile, IsReadableWhileItIsWritten) {
  const sample_run::Folder folder;
  const std::string path = folder / "run.vtkhdf", copy = folder / "copy.vtkhdf";
  RunFile file(path, sample_run::parts(), sample_run::info(2));
  for (int s = 0; s < 5; ++s) {
    sample_run::append(file, s);
    // the file as after a crash at this time
    std::filesystem::copy_file(path, copy, std::filesystem::copy_options::overwrite_existing);
    expect_steps(copy, s + 1);
  }
}

TEST(RunFile, OneChunkMayBeSmallerThanAStep) {
  const sample_run::Folder folder;
  const std::string path = folder / "large.vtkhdf";
  const int n = 300000;  // 7 MB of positions per step
  store::RunPart part{
      .name = "cloud", .reference = Points::Zero(3, n), .tets = Tets(4, 0), .faces = Faces(3, 0)};
  {
    RunFile file(path, {part}, sample_run::info(2));
    for (int s = 0; s < 2; ++s)
      file.append(s, Points::Constant(3, n, s + 1.0), Points::Zero(3, n), VecX::Constant(n, s));
  }
  const RunReader run(path);
  EXPECT_EQ(run.points(1).minCoeff(), 2.0);
  EXPECT_EQ(run.points(0).maxCoeff(), 1.0);
  EXPECT_EQ(run.stress(1).minCoeff(), 1.0);
}

TEST(RunFile, IsCounted) {
  const sample_run::Folder folder;
  counters::reset();
  RunFile file(folder / "run.vtkhdf", sample_run::parts(), sample_run::info(1));
  EXPECT_EQ(counters::counter("store.run_file"), 1);
}

TEST(RunFile, RefusesWhatMustNotBeRecorded) {
  const sample_run::Folder folder;
  RunFile file(folder / "run.vtkhdf", sample_run::parts(), sample_run::info(1));
  Points bad = sample_run::points(0);
  bad(1, 2) = std::nan("");
  EXPECT_THROW(file.append(0.0, bad, sample_run::velocity(0), sample_run::stress(0)), InternalError);
  EXPECT_THROW(file.append(0.0, Points::Zero(3, 2), sample_run::velocity(0), sample_run::stress(0)),
               InternalError);
  file.close();
  EXPECT_THROW(sample_run::append(file, 0), InternalError);
  auto parts = sample_run::parts();
  parts[0].tets(0, 0) = 5;
  EXPECT_THROW(RunFile(folder / "bad.vtkhdf", parts, sample_run::info(1)), InternalError);
}

std::string refusal(const auto& action) {
  try {
    action();
  } catch (const Error& e) { return e.what(); }
  return "accepted";
}

TEST(RunFile, ErrorsNameTheFile) {
  const sample_run::Folder folder;
  EXPECT_TRUE(refusal([] { RunFile("/no/such/folder/run.vtkhdf", sample_run::parts(), sample_run::info(1)); })
                  .starts_with("/no/such/folder/run.vtkhdf: cannot be written; check that its folder exists, "
                               "is writable and is not full"));
  EXPECT_EQ(refusal([] { RunReader run("/no/such.vtkhdf"); }), "/no/such.vtkhdf: no such file");
  const std::string text = folder / "text.vtkhdf";
  std::ofstream(text) << "not HDF5";
  EXPECT_TRUE(
      refusal([&] { RunReader run(text); }).starts_with(text + ": is not an HDF5 file that can be read"));
  const std::string path = folder / "run.vtkhdf";
  { RunFile file(path, sample_run::parts(), sample_run::info(1)); }
  EXPECT_EQ(refusal([&] { RunReader(path).points(0); }), path + ": step 0 must lie in [0, 0)");
}

/// A truncated file, or one with changed bytes, is read or rejected, without a crash.
TEST(RunFile, DamagedFilesAreReadOrRefused) {
  const sample_run::Folder folder;
  const std::string path = folder / "run.vtkhdf", damaged = folder / "damaged.vtkhdf";
  {
    RunFile file(path, sample_run::parts(), sample_run::info(2));
    for (int s = 0; s < 2; ++s) sample_run::append(file, s);
  }
  std::ifstream in(path, std::ios::binary);
  const std::string good{std::istreambuf_iterator<char>(in), {}};
  int refused = 0;
  for (std::size_t cut = 0; cut < good.size(); cut += good.size() / 40) {
    std::ofstream(damaged, std::ios::binary) << good.substr(0, cut);
    refused += refusal([&] { RunReader(damaged).points(1); }) != "accepted";
  }
  EXPECT_GE(refused, 35);
}

}  // namespace
