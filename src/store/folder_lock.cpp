#include "store/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "palpate/core/error.h"

namespace palpate::store {
namespace fs = std::filesystem;
namespace {

/// Returns the process that holds the lock of a folder, from the kernel's list (proc(5), /proc/locks):
///   1: FLOCK  ADVISORY  WRITE 1234 fe:00:131074 0 EOF        device as major:minor in hexadecimal, inode
/// 0 if unknown, as for a process of another container.
long owner_of_lock(int folder) {
  struct stat status {};
  if (::fstat(folder, &status) != 0) return 0;
  const std::string requested =
      fmt::format("{:02x}:{:02x}:{}", major(status.st_dev), minor(status.st_dev), status.st_ino);
  std::ifstream locks("/proc/locks");
  for (std::string line; std::getline(locks, line);) {
    std::istringstream words(line);
    std::string number, kind, mode, access, place;
    long process = 0;
    if (words >> number >> kind >> mode >> access >> process >> place && kind == "FLOCK" &&
        place == requested)
      return process;
  }
  return 0;
}

/// Returns the command line of a process, for messages.
std::string command_of(long process) {
  std::ifstream in(fmt::format("/proc/{}/cmdline", process), std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  while (!text.empty() && text.back() == '\0') text.pop_back();
  for (char& c : text)
    if (c == '\0') c = ' ';
  return text;
}

[[noreturn]] void fail_busy(const std::string& path, int folder) {
  std::string who = "another process";
  if (const long process = owner_of_lock(folder); process > 0)
    who = fmt::format("process {} ({})", process, command_of(process));
  fail("{}: {} is writing into this folder; wait until it has ended, or choose another with -o DIR", path,
       who);
}

/// Returns whether the path still leads to an open folder: another process may have removed it.
bool has_path(int folder, const std::string& path) {
  struct stat opened {};
  struct stat named {};
  return ::fstat(folder, &opened) == 0 && ::stat(path.c_str(), &named) == 0 &&
         opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

}  // namespace

void FolderLock::make(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (std::error_code none; !fs::is_directory(path, none))
    fail("{}: this output folder cannot be created ({}); choose another with -o DIR", path,
         error ? error.message() : "a file has this name");
  if (::access(path.c_str(), W_OK | X_OK) != 0)
    fail("{}: this output folder cannot be written ({}); choose another with -o DIR", path,
         std::strerror(errno));
}

FolderLock::FolderLock(const std::string& path, Access access) {
  const int kind = access == Access::kAlone ? LOCK_EX : LOCK_SH;
  do {
    if (lock_ >= 0) ::close(lock_);
    make(path);
    lock_ = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    is_locked_ = lock_ >= 0 && ::flock(lock_, kind | LOCK_NB) == 0;
  } while (is_locked_ && !has_path(lock_, path));
  if (lock_ < 0 || is_locked_ || errno != EWOULDBLOCK) return;
  const int folder = std::exchange(lock_, -1);
  try {
    fail_busy(path, folder);
  } catch (...) {
    ::close(folder);
    throw;
  }
}

FolderLock::~FolderLock() {
  if (lock_ >= 0) ::close(lock_);
}

}  // namespace palpate::store
