#pragma once
#include <toml++/toml.h>

#include <string>

/// Bounds on TOML text that are checked before it is parsed, and bounds on the parsed values.
namespace palpate::scene {

/// Limit of nesting.  Scenes nest three levels: [[device.keyframe]] in a list of inline tables, with a vector
/// in each.
inline constexpr int kMostNested = 16;
/// Limit of the bytes of a key before "=" or between brackets, with its dots.  The longest key of a scene has
/// 50.
inline constexpr int kLongestKey = 256;

/// Checks nesting and key lengths ahead of parsing: the TOML parser recurses into lists and inline tables,
/// and tables of dotted keys are freed by recursion.
/// @param from  origin of the text, for messages: a path, or "--set ..."
/// @throws Error with the line where lists, tables or dotted keys nest deeper than kMostNested, or a key is
///   longer than kLongestKey
void check_bounds(const std::string& text, const std::string& from);

/// Rejects whole numbers beyond 2^53, which may have no exact double, and texts with control characters or
/// more than one line: no name or path needs one, and they would appear in messages, reports and terminals.
/// @throws Error with the location of the first one
void check_values(const toml::table& root);

}  // namespace palpate::scene
