#include "scene/document.h"

#include <sstream>

#include "palpate/core/error.h"
#include "scene/toml_bounds.h"
#include "scene/toml_text.h"

namespace palpate::scene {
namespace {
/// Returns the text of the scene as it runs; comments survive only without overrides.
std::string effective_source(const toml::table& root, const std::string& text,
                             const std::vector<std::string>& overrides) {
  if (overrides.empty()) return text;
  std::ostringstream out;
  for (const std::string& one : overrides) out << "# " << kOverride << one << '\n';
  out << toml::toml_formatter(root) << '\n';
  return out.str();
}
}  // namespace

Document parse_document(const std::string& text, const std::string& path,
                        const std::vector<std::string>& overrides) {
  Document document;
  document.path = path.empty() ? "scene" : path;
  check_bounds(text, document.path);
  try {
    document.root = toml::parse(text, document.path);
  } catch (const toml::parse_error& e) {
    fail("{}: not valid TOML: {}", location(e.source()), e.description());
  }
  document.overrides = overrides;
  if (!overrides.empty()) document.original = document.root;
  for (const std::string& one : overrides) apply_override(document.root, one);
  check_values(document.root);
  document.source = effective_source(document.root, text, overrides);
  return document;
}

void leave_out(Document& document, const std::string& table, const std::string& key) {
  const auto found = toml::at_path(document.root, table);
  PALPATE_CHECK(found && found.is_table(), "{} is not a table", table);
  found.as_table()->erase(key);
  document.source = effective_source(document.root, "", document.overrides);
}

std::string location(const Document& document, std::string at) {
  for (;;) {
    if (const auto found = toml::at_path(document.root, at)) return location(found.node()->source());
    const std::size_t cut = at.find_last_of(".[");
    if (cut == std::string::npos) return document.path;
    at.resize(cut);
  }
}

bool given(const Document& document, std::string_view at) {
  return static_cast<bool>(toml::at_path(document.root, at));
}

}  // namespace palpate::scene
