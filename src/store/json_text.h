#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace palpate::store {

/// Parses JSON.  Results of palpate have three levels of objects; deeper nesting than kMostNested is
/// rejected, which bounds every recursion over them.
/// @param path  origin of the text, for messages
/// @throws Error for text that is no JSON, nests deeper than 64, or contains a whole number beyond 2^53
nlohmann::ordered_json parse_json(const std::string& text, const std::string& path);

}  // namespace palpate::store
