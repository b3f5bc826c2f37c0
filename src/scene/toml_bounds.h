#pragma once
#include <toml++/toml.h>

#include <string>

/// Bounds on TOML text that hold before its parser sees it, and on the values that the parser gives.
namespace palpate::scene {

/// Scenes nest three deep: [[device.keyframe]] in a list of inline tables, with a vector in each.
inline constexpr int kMostNested = 16;
/// Bytes of a key as it stands before "=" or between brackets, with its dots.  The longest of a scene has 50.
inline constexpr int kLongestKey = 256;

/// The parser of TOML recurses into lists and inline tables, and tables of dotted keys are freed by
/// recursion.
/// @param from  of the text, for messages: a path, or "--set ..."
/// @throws Error with the line where lists, tables or dotted keys nest deeper than kMostNested, or a key is
///   longer than kLongestKey
void check_bounds(const std::string& text, const std::string& from);

/// Refuses whole numbers beyond 2^53, which may have no double that equals them, and texts with control
/// characters or more than one line: no name or path needs one, and messages, reports and terminals show
/// them.
/// @throws Error with the location of the first one
void check_values(const toml::table& root);

}  // namespace palpate::scene
