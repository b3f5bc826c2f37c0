#pragma once
#include <gtest/gtest.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>

namespace palpate {

/// Temporary folder of one test, with a unique name, so that concurrent tests and users on one machine do not
/// collide. It is removed with its owner, unless the test has failed: then it is kept for inspection, and its
/// path is printed.
class TemporaryFolder {
 public:
  /// Creates the folder in the system's folder for temporary files ($TMPDIR).
  TemporaryFolder() : TemporaryFolder(std::filesystem::temp_directory_path()) {}
  /// @param parent  another location: "/dev/shm" for thousands of small files
  explicit TemporaryFolder(const std::filesystem::path& parent) {
    std::string pattern = (parent / "palpate-test-XXXXXX").string();
    if (!::mkdtemp(pattern.data()))
      throw std::runtime_error("no folder can be made in " + parent.string() + ": " + std::strerror(errno));
    path_ = pattern;
    owner_ = ::getpid();
  }
  ~TemporaryFolder() {
    if (::getpid() != owner_) return;  // a process forked by the test
    if (testing::Test::HasFailure()) {
      std::printf("kept for a look: %s\n", path_.c_str());
      return;
    }
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::string string() const { return path_.string(); }
  std::filesystem::path operator/(const std::filesystem::path& name) const { return path_ / name; }
  /// Writes a file into the folder. @return its path
  std::filesystem::path write(const std::string& name, std::string_view text) const {
    std::ofstream(path_ / name, std::ios::binary) << text;
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
  pid_t owner_ = 0;
};

}  // namespace palpate
