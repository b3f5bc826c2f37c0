#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace palpate::report {

/// Keeps the order of the file: its writer put the important things first.
using Json = nlohmann::ordered_json;

/// Throws Error with the file and the parser's message (which has line and column).
Json read_json(const std::filesystem::path& path);

/// The number under a key; NaN when absent, null or not a number.
double number_at(const Json& object, const char* key);

/// The text under a key; `otherwise` when absent or not text.
std::string text_at(const Json& object, const char* key, const std::string& otherwise = "");

/// A value for people: numbers short, lists joined by commas, "yes" and "no"; empty for null and for lists of
/// objects.
std::string value_text(const Json& value);

/// "cpu_s" -> "cpu [s]", "max_force_n" -> "max force [N]": a key whose unit stands at its end, for people.
std::string key_text(const std::string& key);

/// The entries of an object that are not objects themselves.
std::vector<std::pair<std::string, std::string>> facts_of(const Json& object);

}  // namespace palpate::report
