#include "store/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "palpate/core/error.h"

namespace palpate::store {
namespace {

std::string draft_of(const std::string& path) { return fmt::format("{}.{}.part", path, getpid()); }

void write(const std::string& path, std::string_view content, bool durably) {
  const std::string temporary = draft_of(path);
  {
    errno = 0;
    std::ofstream out(temporary, std::ios::binary | std::ios::trunc);
    out.write(content.data(), static_cast<std::streamsize>(content.size()));
    out.close();
    if (!out) {
      const std::string reason = errno != 0 ? std::strerror(errno) : "no reason given";
      std::error_code ignored;
      std::filesystem::remove(temporary, ignored);
      fail("{}: cannot be written ({}); check that its folder exists, is writable and is not full", path,
           reason);
    }
  }
  if (durably) sync_file(temporary);
  std::error_code error;
  std::filesystem::rename(temporary, path, error);
  if (!error) {
    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    // The folder's entry for the new name.
    if (durably) sync_file(folder.empty() ? "." : folder.string());
    return;
  }
  std::error_code ignored;
  std::filesystem::remove(temporary, ignored);
  fail("{}: cannot be replaced: {}", path, error.message());
}

}  // namespace

void write_atomically(const std::string& path, std::string_view content) { write(path, content, false); }
void write_durably(const std::string& path, std::string_view content) { write(path, content, true); }

void check_can_write(const std::string& path) {
  std::error_code none;
  if (std::filesystem::is_directory(path, none)) fail("{}: is a folder; give a file", path);
  const std::string draft = draft_of(path);
  const int file = open(draft.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  if (file < 0)
    fail("{}: cannot be written ({}); check that its folder exists and is writable", path,
         std::strerror(errno));
  close(file);
  std::filesystem::remove(draft, none);
}

void sync_file(const std::string& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  // EINVAL: the file cannot be synchronised.
  const bool done = file >= 0 && (fsync(file) == 0 || errno == EINVAL);
  const int reason = errno;
  if (file >= 0) close(file);
  if (!done) fail("{}: cannot be flushed to disk: {}", path, std::strerror(reason));
}

void check_reaches(const std::string& path, std::int64_t bytes) {
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  if (error) fail("{}: the run cannot be resumed without this file: {}", path, error.message());
  if (bytes < 0 || size < static_cast<std::uintmax_t>(bytes))
    fail("{}: has {} bytes, but had {} at the checkpoint; it was changed since, run the scene again", path,
         size, bytes);
}

void truncate_file(const std::string& path, std::int64_t bytes) {
  check_reaches(path, bytes);
  std::error_code error;
  std::filesystem::resize_file(path, static_cast<std::uintmax_t>(bytes), error);
  if (error) fail("{}: cannot be truncated to its checkpoint: {}", path, error.message());
}

void check_content(const std::string& path, const ContentHash& found, const std::string& written) {
  if (found.hex() != written)
    fail(
        "{}: differs from its content at the checkpoint; the file was changed or damaged since, run the "
        "scene again",
        path);
}

std::string read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in || !std::filesystem::is_regular_file(path)) fail("{}: no such file, or it cannot be read", path);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

}  // namespace palpate::store
