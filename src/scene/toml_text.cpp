#include "scene/toml_text.h"

#include "palpate/core/error.h"

namespace palpate::scene {

std::string location(const toml::source_region& region) {
  const std::string path = region.path ? *region.path : "scene";
  if (path.starts_with(kOverride) || !region.begin) return path;
  return fmt::format("{}:{}:{}", path, region.begin.line, region.begin.column);
}

std::string shown(const toml::node& node) {
  if (const auto* text = node.as_string())
    return text->get().size() <= 60 ? '"' + text->get() + '"' : "a longer string";
  if (const auto* number = node.as_floating_point()) return fmt::format("{}", number->get());
  if (const auto* number = node.as_integer()) return fmt::format("{}", number->get());
  if (const auto* truth = node.as_boolean()) return truth->get() ? "true" : "false";
  const toml::array* array = node.as_array();
  if (!array) return node.is_table() ? "a table" : "a date or time";
  if (array->size() > 6) return fmt::format("a list of {}", array->size());
  std::string text;
  for (const toml::node& one : *array)
    text += (text.empty() ? "" : ", ") + (one.is_array() ? std::string("[...]") : shown(one));
  return "[" + text + "]";
}

}  // namespace palpate::scene
