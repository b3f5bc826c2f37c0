// Compiled programs are cached on disk, and damaged cache entries are recompiled.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "core/counters.h"
#include "gl/context.h"
#include "gl/program.h"

using namespace palpate;
namespace fs = std::filesystem;

namespace {

class GlProgramCache : public ::testing::Test {
 protected:
  void SetUp() override {
    gl::Context::shared();
    folder_ = fs::temp_directory_path() / ("palpate-shaders-" + std::to_string(::getpid()));
    fs::remove_all(folder_);
    ::setenv("XDG_CACHE_HOME", folder_.c_str(), 1);
  }
  void TearDown() override {
    fs::remove_all(folder_);
    ::unsetenv("XDG_CACHE_HOME");
  }
  /// Creates a program; returns how many were compiled and how many were loaded from the cache.
  std::pair<long, long> make() {
    const auto count = [](const char* name) { return static_cast<long>(counters::counter(name).load()); };
    const long compiled = count("gl.program_compiled"), loaded = count("gl.program_from_cache");
    const gl::Program program("contact/skin.vert", "contact/skin.frag");
    program.use();
    gl::check_errors("the test");
    return {count("gl.program_compiled") - compiled, count("gl.program_from_cache") - loaded};
  }
  std::vector<fs::path> files() const {
    std::vector<fs::path> out;
    const fs::path kept = folder_ / "palpate" / "shaders";
    if (fs::exists(kept))
      for (const auto& entry : fs::directory_iterator(kept)) out.push_back(entry.path());
    return out;
  }
  fs::path folder_;
};

std::string text_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
void write(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

const std::pair<long, long> kCompiled{1, 0}, kFromCache{0, 1};

}  // namespace

TEST_F(GlProgramCache, TheSecondIsNotCompiled) {
  EXPECT_EQ(make(), kCompiled);
  if (files().empty()) GTEST_SKIP() << "this driver hands out no binaries";
  EXPECT_EQ(make(), kFromCache);
  ASSERT_EQ(files().size(), 1u);
  EXPECT_NE(text_of(files()[0]).find(gl::Context::shared().info().version), std::string::npos);
}

TEST_F(GlProgramCache, DamagedFilesAreMadeAgain) {
  make();
  if (files().empty()) GTEST_SKIP() << "this driver hands out no binaries";
  const fs::path path = files()[0];
  const std::string whole = text_of(path);
  std::string flipped = whole, other_driver = whole, huge = whole;
  flipped[whole.size() - 100] ^= 1;
  const std::string version = gl::Context::shared().info().version;
  other_driver[whole.find(version)] ^= 1;
  huge[24 + 7] = 0x7f;  // the size of the binary
  for (const std::string& damaged :
       {flipped, other_driver, huge, whole.substr(0, whole.size() / 2), whole.substr(0, 20), std::string()}) {
    write(path, damaged);
    EXPECT_EQ(make(), kCompiled) << damaged.size();
    EXPECT_EQ(text_of(path), whole);
    EXPECT_EQ(make(), kFromCache);
  }
}

TEST_F(GlProgramCache, NothingIsKeptWhereNothingCanBe) {
  write(folder_, "a file in the folder's place");
  EXPECT_EQ(make(), kCompiled);
  EXPECT_EQ(make(), kCompiled);
  fs::remove_all(folder_);
  ::unsetenv("XDG_CACHE_HOME");
  const char* home = std::getenv("HOME");
  const std::string before = home ? home : "";
  ::unsetenv("HOME");
  EXPECT_EQ(make(), kCompiled);
  if (home) ::setenv("HOME", before.c_str(), 1);
}
