#include "scene/read_text.h"

#include <filesystem>
#include <fstream>

#include "palpate/core/error.h"

namespace palpate::scene {
namespace {

constexpr std::uintmax_t kLargestBytes = 16u << 20;

}  // namespace

std::string read_text_file(const std::string& path, const char* what, const char* help) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (error || !std::filesystem::exists(status)) fail("{}: no such {} file; {}", path, what, help);
  if (std::filesystem::is_directory(status))
    fail("{}: is a folder; give a {} file (.toml) in it", path, what);
  std::ifstream in(path, std::ios::binary);
  if (!in) fail("{}: cannot be opened; check its permissions", path);
  std::string text;
  for (char block[65536]; in.read(block, sizeof block) || in.gcount() > 0;) {
    text.append(block, static_cast<std::size_t>(in.gcount()));
    if (text.size() > kLargestBytes)
      fail("{}: larger than {} MiB; is this a {}?", path, kLargestBytes >> 20, what);
  }
  return text;
}
}  // namespace palpate::scene
