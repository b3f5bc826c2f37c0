#include "palpate/store/atomic_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "palpate/core/error.h"

namespace palpate::store {

void write_atomically(const std::string& path, std::string_view content) {
  const std::string temporary = fmt::format("{}.{}.part", path, getpid());
  {
    errno = 0;
    std::ofstream out(temporary, std::ios::binary | std::ios::trunc);
    out.write(content.data(), static_cast<std::streamsize>(content.size()));
    out.close();
    if (!out) {
      const std::string reason = errno != 0 ? std::strerror(errno) : "no reason given";
      std::error_code ignored;
      std::filesystem::remove(temporary, ignored);
      fail("{}: cannot be written ({}); is its folder there, writable, and not full?", path, reason);
    }
  }
  std::error_code error;
  std::filesystem::rename(temporary, path, error);
  if (!error) return;
  std::error_code ignored;
  std::filesystem::remove(temporary, ignored);
  fail("{}: cannot be replaced: {}", path, error.message());
}

std::string read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in || !std::filesystem::is_regular_file(path)) fail("{}: no such file, or it cannot be read", path);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

}  // namespace palpate::store
