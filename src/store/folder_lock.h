#pragma once
#include <string>
#include <utility>

namespace palpate::store {

/// Lock on the output folder of a command, against other processes: two runs into one folder would mix their
/// files. The lock (flock on the folder itself) ends with the process, however it ends, and leaves no file
/// behind. File systems without locks are used without one.
class FolderLock {
 public:
  FolderLock() = default;
  /// kShared: several processes may share the folder, each writing distinct files, and none can lock it
  /// alone.
  enum class Access { kAlone, kShared };
  /// Creates the folder where it is missing, and locks it.
  /// @throws Error where it cannot be created or written, or where another process holds it; the message
  ///   identifies that process
  explicit FolderLock(const std::string& path, Access access = Access::kAlone);
  /// Creates the folder, without a lock.  @throws Error where it cannot be created or written
  static void make(const std::string& path);
  ~FolderLock();
  FolderLock(FolderLock&& other) noexcept
      : lock_(std::exchange(other.lock_, -1)), is_locked_(std::exchange(other.is_locked_, false)) {}
  FolderLock& operator=(FolderLock&& other) noexcept {
    std::swap(lock_, other.lock_);
    std::swap(is_locked_, other.is_locked_);
    return *this;
  }
  /// Returns whether the lock is held; false on a file system without locks.
  bool is_locked() const { return is_locked_; }

 private:
  int lock_ = -1;
  bool is_locked_ = false;
};

}  // namespace palpate::store
