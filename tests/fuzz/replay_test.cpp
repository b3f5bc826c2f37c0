// Replays every input of the corpora, and mutations of it, without a fuzzer: regression test for inputs that
// once broke a reader.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "fuzz/targets.h"

namespace fs = std::filesystem;
using palpate::fuzz::Target;
using palpate::fuzz::targets;

namespace {

const fs::path kCorpora = PALPATE_FUZZ_CORPORA;

std::string read(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<fs::path> inputs_of(const Target& target) {
  std::vector<fs::path> out;
  for (const auto& entry : fs::directory_iterator(kCorpora / target.name)) out.push_back(entry.path());
  std::sort(out.begin(), out.end());
  return out;
}

class Replay : public testing::TestWithParam<Target> {};

TEST_P(Replay, EveryInputIsReadOrRefused) {
  const std::vector<fs::path> inputs = inputs_of(GetParam());
  EXPECT_GE(inputs.size(), 1u) << "seeds are missing";
  for (const fs::path& input : inputs) {
    SCOPED_TRACE(input.string());
    EXPECT_NO_THROW(GetParam().run(read(input)));
  }
}

/// Files truncated at any byte, as by an interrupted copy.
TEST_P(Replay, ATruncatedInputIsReadOrRefused) {
  constexpr std::size_t kCuts = 60;
  for (const fs::path& input : inputs_of(GetParam())) {
    const std::string whole = read(input);
    SCOPED_TRACE(input.string());
    for (std::size_t cut = 0; cut < whole.size(); cut += 1 + whole.size() / kCuts)
      EXPECT_NO_THROW(GetParam().run(std::string_view(whole).substr(0, cut))) << "cut at byte " << cut;
  }
}

std::string name_of(const testing::TestParamInfo<Target>& info) { return info.param.name; }
INSTANTIATE_TEST_SUITE_P(Targets, Replay, testing::ValuesIn(targets()), name_of);

TEST(Corpora, BelongToTargets) {
  for (const auto& entry : fs::directory_iterator(kCorpora)) {
    const std::string name = entry.path().filename().string();
    // targets of foreign meshes exist only with meshing
    const bool foreign = name == "medit" || name == "vtu" || name == "vtk" || name == "polygons";
    if (foreign) continue;
    EXPECT_NO_THROW(palpate::fuzz::target(name));
  }
  EXPECT_THROW(palpate::fuzz::target("no such format"), std::invalid_argument);
}

}  // namespace
