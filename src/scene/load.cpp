#include "palpate/scene/load.h"

#include <filesystem>

#include "palpate/core/error.h"
#include "scene/check.h"
#include "scene/check_kinds.h"
#include "scene/keys.h"
#include "scene/read_text.h"

namespace palpate::scene {
Description parse(const std::string& text, const std::string& path, const std::vector<std::string>& overrides,
                  const Kinds& kinds) {
  Document document = parse_document(text, path, overrides);
  fill_in_values(document, kinds);
  Description description;
  read_table(document.root, "", description_keys(), description);
  std::vector<std::string> not_carried_over;
  for (;;) {  // Removing a key may change the chosen kind.
    const std::vector<DroppedKey> left = check_kinds(document, description, kinds);
    if (left.empty()) break;
    for (const DroppedKey& one : left) {
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
  const char* help = "`palpate list scenes` shows those that come with palpate";
  return parse(read_text_file(path, "scene", help), path, overrides, kinds);
}

std::string place_of(const Description& description, const std::string& at) {
  const std::string& path = description.path;
  try {
    std::error_code none;
    const bool is_file = std::filesystem::is_regular_file(path, none);
    const std::string text = is_file ? read_text_file(path, "scene", "") : description.source;
    return location(parse_document(text, path, {}), at);
  } catch (const Error&) { return path.empty() ? "scene" : path; }
}

std::vector<std::string> known_keys(const Kinds& kinds) {
  std::vector<std::string> out;
  for (const KeyRow& row : key_rows(kinds))
    out.push_back(row.table.empty() ? row.name : row.table + "." + row.name);
  return out;
}

}  // namespace palpate::scene
