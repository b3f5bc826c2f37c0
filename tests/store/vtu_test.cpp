#include "store/vtu.h"

#include "palpate/core/error.h"
#include "store/atomic_file.h"
#include "store/python_check.h"
#include "store/sample_run.h"

namespace {

using palpate::store::RunReader;
using python_check::rows_of;

class Vtu : public python_check::Test {
 protected:
  Vtu() {
    const std::string path = folder_ / "run.vtkhdf";
    palpate::store::RunFile file(path, sample_run::parts(), sample_run::info(3));
    for (int s = 0; s < 3; ++s) sample_run::append(file, s);
  }

  nlohmann::json seen(int step, const std::vector<int>& parts) {
    palpate::store::write_atomically(folder_ / "one.vtu", palpate::store::vtu_of(run(), step, parts));
    return python_check::foreign("vtu", folder_ / "one.vtu");
  }
  RunReader run() { return RunReader(folder_ / "run.vtkhdf"); }

  sample_run::Folder folder_;
};

TEST_F(Vtu, HoldsAllOfAStep) {
  const nlohmann::json file = seen(2, {0, 1});
  EXPECT_EQ(file["time"], sample_run::time(2));
  EXPECT_EQ(file["Points"], rows_of(sample_run::points(2)));
  EXPECT_EQ(file["displacement"], rows_of(sample_run::displacement(2)));
  EXPECT_EQ(file["velocity"], rows_of(sample_run::velocity(2)));
  const palpate::VecX stress = sample_run::stress(2);
  EXPECT_EQ(file["stress"], std::vector<double>(stress.begin(), stress.end()));
  EXPECT_EQ(file["connectivity"], (std::vector<int>{0, 1, 2, 3, 1, 2, 3, 4, 5, 6, 7}));
  EXPECT_EQ(file["offsets"], (std::vector<int>{4, 8, 11}));
  EXPECT_EQ(file["types"], (std::vector<int>{10, 10, 5})) << "VTK_TETRA, VTK_TETRA, VTK_TRIANGLE";
  EXPECT_EQ(file["body"], (std::vector<int>{0, 0, 1}));
}

TEST_F(Vtu, OfOnePart) {
  const nlohmann::json file = seen(1, {1});
  EXPECT_EQ(file["Points"], rows_of(sample_run::points(1).rightCols(3)));
  EXPECT_EQ(file["velocity"], rows_of(sample_run::velocity(1).rightCols(3)));
  const palpate::VecX stress = sample_run::stress(1).tail(3);
  EXPECT_EQ(file["stress"], std::vector<double>(stress.begin(), stress.end()));
  EXPECT_EQ(file["connectivity"], (std::vector<int>{0, 1, 2})) << "counted in the points that are there";
  EXPECT_EQ(file["body"], (std::vector<int>{1})) << "its number in the run";
}

TEST_F(Vtu, CollectionNamesTimesAndFiles) {
  palpate::store::write_atomically(folder_ / "run.pvd",
                                   palpate::store::pvd_of({{0.0, "a&b_0000.vtu"}, {0.1, "a&b_0001.vtu"}}));
  const nlohmann::json seen = python_check::foreign("pvd", folder_ / "run.pvd");
  EXPECT_EQ(seen, nlohmann::json::parse(R"([[0.0, "a&b_0000.vtu"], [0.1, "a&b_0001.vtu"]])"));
}

TEST_F(Vtu, RefusesAStepThatIsNotThere) {
  EXPECT_THROW(palpate::store::vtu_of(run(), 3, {0}), palpate::Error);
}

}  // namespace
