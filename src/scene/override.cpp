#include <algorithm>
#include <charconv>
#include <set>

#include "palpate/core/error.h"
#include "scene/document.h"
#include "scene/keys.h"
#include "scene/toml_bounds.h"

namespace palpate::scene {
namespace {

std::string trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return "";
  return std::string(text.substr(first, text.find_last_not_of(" \t") - first + 1));
}

std::vector<std::string> split(const std::string& path) {
  std::vector<std::string> parts(1);
  for (const char c : path) {
    if (c == '.')
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

/// Whether the text is a name or a path: no character has a meaning in TOML outside quotes.
bool is_bare_word(const std::string& text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::isalnum(c) || std::string_view("_-./~").find(static_cast<char>(c)) != std::string_view::npos;
  });
}

/// Returns the dotted name of a key without indices, by the table in which the keys are listed: a hand has
/// those of [tool] and [device].
std::string listed_name(const std::vector<std::string>& parts) {
  std::string out;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::string& part = parts[i];
    const bool is_index =
        std::all_of(part.begin(), part.end(), [](unsigned char c) { return std::isdigit(c); });
    const bool is_hand = i == 0 && part == "hand" && parts.size() > 3;
    if (!is_index && !is_hand) out += (out.empty() ? "" : ".") + part;
  }
  return out;
}

/// Returns whether the scene's key at that path takes a text.
bool takes_text(const std::vector<std::string>& parts) {
  static const std::set<std::string> texts = [] {
    std::set<std::string> out;
    for (const KeyRow& row : rows_of("", description_keys()))
      if (row.type == "text") out.insert(row.table.empty() ? row.name : row.table + "." + row.name);
    return out;
  }();
  return texts.count(listed_name(parts)) > 0;
}

/// Returns a text in the quotes of TOML, in which only backslashes, quotes and control characters have a
/// meaning.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text)
    if (c == '\\' || c == '"')
      out += {'\\', c};
    else if (c == '\t' || c == '\n')
      out += c == '\t' ? "\\t" : "\\n";
    else
      out += c;
  return out + '"';
}

/// Parses the value after `=`. Where the key takes a text, an unquoted value is the text, whatever it looks
/// like: device.library_options=5005. Elsewhere, too, a bare word or path is taken as a text, because a shell
/// removes quotes.
toml::table parse_value(const std::string& value, const std::string& from, bool is_text) {
  if (is_text && value.front() != '"' && value.front() != '\'')
    return toml::parse("value = " + quoted(value), from);
  try {
    toml::table parsed = toml::parse("value = " + value, from);
    if (parsed.size() == 1) return parsed;
  } catch (const toml::parse_error&) {
    if (is_bare_word(value)) return toml::parse("value = \"" + value + "\"", from);
  }
  fail("{}: `{}` is not a single TOML value; write a number, true, false, a word, [1, 2, 3] or \"text\"",
       from, value);
}

std::size_t array_index(const toml::array& array, const std::string& part, const std::string& from) {
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), index);
  if (error != std::errc{} || end != part.data() + part.size() || index >= array.size())
    fail("{}: \"{}\" must be an index from 0 to {}", from, part, static_cast<long>(array.size()) - 1);
  return index;
}

std::vector<std::string> keys_of(const toml::table& table) {
  std::vector<std::string> keys;
  for (const auto& [key, node] : table) keys.emplace_back(key.str());
  return keys;
}

/// Returns the node called `part` inside `node`; a missing table is created (the reader rejects it later if
/// no such table is known).
toml::node& descend(toml::node& node, const std::string& part, const std::string& next,
                    const toml::source_region& region) {
  const std::string& from = *region.path;
  if (toml::array* array = node.as_array()) return *array->get(array_index(*array, part, from));
  toml::table* table = node.as_table();
  if (!table) fail("{}: \"{}\" is inside a value that is not a table", from, part);
  if (!table->contains(part)) {
    const bool index_follows = !next.empty() && std::all_of(next.begin(), next.end(),
                                                            [](unsigned char c) { return std::isdigit(c); });
    if (part.empty() || index_follows)
      fail("{}: the scene has no \"{}\"{}", from, part, suggestion(part, keys_of(*table)));
    table->insert(toml::key(part, region), toml::table{});
  }
  return *table->get(part);
}

void assign(toml::node& node, const std::string& part, toml::node& value, const toml::source_region& region) {
  value.visit([&](auto& typed) {  // Moved, not copied: only a moved node keeps its location.
    if (toml::array* array = node.as_array()) {
      const std::size_t index = array_index(*array, part, *region.path);
      array->erase(array->cbegin() + static_cast<std::ptrdiff_t>(index));
      array->insert(array->cbegin() + static_cast<std::ptrdiff_t>(index), std::move(typed));
    } else if (toml::table* table = node.as_table(); table && !part.empty()) {
      table->erase(part);
      table->insert(toml::key(part, region), std::move(typed));
    } else {
      fail("{}: \"{}\" is inside a value that is not a table", *region.path, part);
    }
  });
}

/// Rejects control characters, which terminals do not show and which would end a message early.
void refuse_control_characters(const std::string& text) {
  const auto is_control = [](unsigned char c) { return c < ' ' && c != '\t' && c != '\n'; };
  if (std::none_of(text.begin(), text.end(), is_control)) return;
  std::string shown = text.substr(0, 60);
  for (char& c : shown)
    if (is_control(static_cast<unsigned char>(c))) c = '?';
  fail("--set {}: has control characters, which no key or value may have", shown);
}

}  // namespace

void apply_override(toml::table& root, const std::string& text) {
  refuse_control_characters(text);
  constexpr std::size_t kShown = 200;
  check_bounds(text, "--set " + (text.size() <= kShown ? text : text.substr(0, kShown) + "..."));
  const std::string from = "--set " + text;
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || trimmed(text.substr(0, equals)).empty() ||
      trimmed(text.substr(equals + 1)).empty())
    fail("{}: must be PATH=VALUE, as in body.0.youngs_modulus_pa=1e5", from);
  const std::vector<std::string> parts = split(trimmed(text.substr(0, equals)));
  toml::table parsed = parse_value(trimmed(text.substr(equals + 1)), from, takes_text(parts));
  toml::node& value = *parsed.get("value");
  const toml::source_region region = value.source();

  toml::node* node = &root;
  for (std::size_t i = 0; i + 1 < parts.size(); ++i) node = &descend(*node, parts[i], parts[i + 1], region);
  assign(*node, parts.back(), value, region);
}

}  // namespace palpate::scene
