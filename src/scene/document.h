#pragma once
#include <toml++/toml.h>

#include <string>
#include <string_view>
#include <vector>

namespace palpate::scene {

/// Parsed scene with its overrides applied.  Every node carries its location: in the file, or in an override.
struct Document {
  toml::table root;
  toml::table original;  ///< State before overrides, without locations; empty without overrides.
  std::string path;      ///< Path as shown in messages.
  std::string source;    ///< TOML that parses to `root` again.
  std::vector<std::string> overrides;
};

/// Parses `text` and applies the overrides.  @throws Error with the location, for bad TOML and bad overrides
Document parse_document(const std::string& text, const std::string& path,
                        const std::vector<std::string>& overrides);

/// Removes a key from a table, such as "contact[1]", and from the source.
void leave_out(Document& document, const std::string& table, const std::string& key);

/// Returns the location of the deepest part of `at` that exists: `body[1].mesh.radius_m`, else
/// `body[1].mesh`, ...
std::string location(const Document& document, std::string at);

/// Whether the scene contains this key.
bool given(const Document& document, std::string_view at);

/// Sets one value by its dotted path: `body.0.youngs_modulus_pa=1e5`.  @throws Error that begins with the
/// override's text
void apply_override(toml::table& root, const std::string& text);

}  // namespace palpate::scene
