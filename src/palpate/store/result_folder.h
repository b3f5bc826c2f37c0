#pragma once
#include <string>
#include <utility>

namespace palpate::store {

/// A folder that a command writes its results into, and nobody else while it does: two runs into one folder
/// would mix their files.  The lock (flock on the folder itself) goes with the process, however it ends, and
/// leaves no file behind.  Where the file system has no locks, there is none.
class ResultFolder {
 public:
  ResultFolder() = default;
  /// kShared: others may share it, each writing files of its own, and nobody has it alone.
  enum class Access { kAlone, kShared };
  /// Makes the folder where it is missing, and locks it.
  /// @throws Error where it cannot be made or written, or another process has it: that one is named
  explicit ResultFolder(const std::string& path, Access access = Access::kAlone);
  /// Makes the folder, and takes no lock.  @throws Error where it cannot be made or written
  static void make(const std::string& path);
  ~ResultFolder();
  ResultFolder(ResultFolder&& other) noexcept : lock_(std::exchange(other.lock_, -1)) {}
  ResultFolder& operator=(ResultFolder&& other) noexcept {
    std::swap(lock_, other.lock_);
    return *this;
  }

 private:
  int lock_ = -1;
};

}  // namespace palpate::store
