#pragma once
#include <toml++/toml.h>

#include <string>
#include <string_view>

/// TOML nodes as messages show them.
namespace palpate::scene {

/// Beginning of the source path of a node set by an override.
inline constexpr std::string_view kOverride = "--set ";

/// Returns `FILE:LINE:COLUMN`, or `--set PATH=VALUE` for a node set by an override.
std::string location(const toml::source_region& region);

/// Formats a node as messages show it, close to the user's notation.
std::string shown(const toml::node& node);

}  // namespace palpate::scene
