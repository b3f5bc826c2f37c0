#include "palpate/scene/load.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include "palpate/core/error.h"
#include "scene/check.h"
#include "scene/check_kinds.h"
#include "scene/keys.h"

namespace palpate::scene {
namespace {
constexpr std::uintmax_t kLargestSceneBytes = 16u << 20;  // a scene names meshes, it does not hold them

std::string read_text_file(const std::string& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (error || !std::filesystem::exists(status))
    fail("{}: no such scene file; `palpate list scenes` shows those that come with palpate", path);
  if (std::filesystem::is_directory(status)) fail("{}: is a folder; name a scene file (.toml) in it", path);
  std::ifstream in(path, std::ios::binary);
  if (!in) fail("{}: cannot be opened; check its permissions", path);
  std::string text;
  for (char block[65536]; in.read(block, sizeof block) || in.gcount() > 0;) {
    text.append(block, static_cast<std::size_t>(in.gcount()));
    if (text.size() > kLargestSceneBytes)
      fail("{}: larger than {} MiB; is this a scene?", path, kLargestSceneBytes >> 20);
  }
  return text;
}
}  // namespace

Description parse(const std::string& text, const std::string& path, const std::vector<std::string>& overrides,
                  const Kinds& kinds) {
  Document document = parse_document(text, path, overrides);
  Description description;
  read_table(document.root, "", description_keys(), description);
  std::vector<std::string> not_carried_over;
  for (;;) {  // a key that is left out may have named a kind
    const std::vector<LeftKey> left = check_kinds(document, description, kinds);
    if (left.empty()) break;
    for (const LeftKey& one : left) {
      leave_out(document, one.table, one.key);
      not_carried_over.push_back(one.table + "." + one.key);
    }
    description = {};
    read_table(document.root, "", description_keys(), description);
  }
  description.not_carried_over = std::move(not_carried_over);
  check(document, description);
  description.path = path;
  description.source = document.source;
  return description;
}

Description load(const std::string& path, const std::vector<std::string>& overrides, const Kinds& kinds) {
  return parse(read_text_file(path), path, overrides, kinds);
}

std::vector<std::string> known_keys(const Kinds& kinds) {
  std::vector<std::string> out;
  for (const KeyRow& row : key_rows(kinds))
    out.push_back(row.table.empty() ? row.name : row.table + "." + row.name);
  return out;
}

}  // namespace palpate::scene
