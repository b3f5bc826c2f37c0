#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace palpate::store {

/// JSON from a text.  Palpate writes three levels of objects; deeper ones are refused at kMostNested, so that
/// nothing that walks over them recurses without bound.
/// @param path  of the text, for messages
/// @throws Error for text that is no JSON, nests deeper than 64, or holds a whole number beyond 2^53
nlohmann::ordered_json parse_json(const std::string& text, const std::string& path);

}  // namespace palpate::store
