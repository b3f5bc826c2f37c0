#include "gl/program_cache.h"

#include <epoxy/gl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <vector>

#include "core/counters.h"
#include "gl/context.h"

namespace palpate::gl {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t kMagic = 0x70616c7061746531;  // "palpate1": version of the file layout.

/// FNV-1a, 64 bits.
std::uint64_t hash(const void* data, std::size_t bytes, std::uint64_t start = 0xcbf29ce484222325) {
  const auto* p = static_cast<const unsigned char*>(data);
  for (std::size_t i = 0; i < bytes; ++i) start = (start ^ p[i]) * 0x100000001b3;
  return start;
}
std::uint64_t hash(const std::string& text) { return hash(text.data(), text.size()); }

struct Header {
  std::uint64_t magic, key_bytes, format, bytes, checksum;
};

fs::path file_of(const ProgramKey& key) {
  const auto set = [](const char* name) -> const char* {
    const char* value = std::getenv(name);
    return value && *value ? value : nullptr;
  };
  fs::path folder;
  if (const char* cache = set("XDG_CACHE_HOME"))
    folder = fs::path(cache) / "palpate";
  else if (const char* home = set("HOME"))
    folder = fs::path(home) / ".cache" / "palpate";
  else
    return {};
  return folder / "shaders" / fmt::format("{:016x}.bin", hash(key.text));
}

/// Reads a cache file; returns false where it is missing, has another key, or is damaged.
bool read_file(const fs::path& path, const ProgramKey& key, GLenum& format, std::vector<char>& binary) {
  std::ifstream in(path, std::ios::binary);
  Header header{};
  if (!in.read(reinterpret_cast<char*>(&header), sizeof header)) return false;
  constexpr std::uint64_t kLargest = 1u << 28;
  if (header.magic != kMagic || header.key_bytes != key.text.size() || header.bytes > kLargest) return false;
  std::string text(key.text.size(), '\0');
  binary.resize(header.bytes);
  if (!in.read(text.data(), static_cast<std::streamsize>(text.size())) || text != key.text) return false;
  if (!in.read(binary.data(), static_cast<std::streamsize>(binary.size()))) return false;
  format = static_cast<GLenum>(header.format);
  return hash(binary.data(), binary.size()) == header.checksum;
}

}  // namespace

ProgramKey program_key(std::string_view sources) {
  const ContextInfo& info = Context::shared().info();
  return {fmt::format("{}\n{}\n{}\n{}", info.vendor, info.renderer, info.version, sources)};
}

bool load_program(unsigned id, const ProgramKey& key) {
  const fs::path path = file_of(key);
  GLenum format = 0;
  std::vector<char> binary;
  if (path.empty() || !read_file(path, key, format, binary)) return false;
  glProgramBinary(id, format, binary.data(), static_cast<GLsizei>(binary.size()));
  GLint ok = 0;
  glGetProgramiv(id, GL_LINK_STATUS, &ok);
  while (glGetError() != GL_NO_ERROR) {}  // Clears the error of a format that the driver no longer supports.
  if (ok) counters::count("gl.program_from_cache");
  return ok;
}

void keep_program(unsigned id, const ProgramKey& key) {
  const fs::path path = file_of(key);
  GLint formats = 0, bytes = 0;
  glGetIntegerv(GL_NUM_PROGRAM_BINARY_FORMATS, &formats);
  if (path.empty() || formats == 0) return;
  glGetProgramiv(id, GL_PROGRAM_BINARY_LENGTH, &bytes);
  if (bytes <= 0) return;
  std::vector<char> binary(static_cast<std::size_t>(bytes));
  GLenum format = 0;
  glGetProgramBinary(id, bytes, &bytes, &format, binary.data());
  if (glGetError() != GL_NO_ERROR) return;
  binary.resize(static_cast<std::size_t>(bytes));
  const Header header{kMagic, key.text.size(), format, binary.size(), hash(binary.data(), binary.size())};
  std::error_code ignored;
  fs::create_directories(path.parent_path(), ignored);
  // Written under a temporary name: two programs may write it at the same time.
  fs::path draft = path;
  draft += fmt::format(".{}", ::getpid());
  {
    std::ofstream out(draft, std::ios::binary);
    out.write(reinterpret_cast<const char*>(&header), sizeof header);
    out.write(key.text.data(), static_cast<std::streamsize>(key.text.size()));
    out.write(binary.data(), static_cast<std::streamsize>(binary.size()));
    if (!out) {
      fs::remove(draft, ignored);
      return;
    }
  }
  fs::rename(draft, path, ignored);
  if (ignored) fs::remove(draft, ignored);
}

}  // namespace palpate::gl
