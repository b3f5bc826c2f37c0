#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace palpate::report {

/// JSON value that keeps the order of keys in the file: its writer puts the important ones first.
using Json = nlohmann::ordered_json;

/// Reads a JSON file.
/// @throws Error with the file and the message of the parser (with line and column)
Json read_json(const std::filesystem::path& path);

/// Returns a section or list of the figures in summary.json; an empty object or array where there is none.
Json section_of(const Json& summary, const char* name);
Json list_of(const Json& summary, const char* name);

/// Returns the first row of a list whose `key` has that text; an empty object where there is none.
Json row_where(const Json& list, const char* key, const std::string& text);

/// Returns the number of a key; NaN if absent, null or not a number.
double number_at(const Json& object, const char* key);

/// Returns the text of a key; `otherwise` if absent or not text.
std::string text_at(const Json& object, const char* key, const std::string& otherwise = "");

/// Returns a value as readable text: numbers short, lists joined by commas, "yes" and "no"; empty for null
/// and for lists of objects.
std::string value_text(const Json& value);

/// Returns a key as readable text, with the unit at its end in brackets: "cpu_s" -> "cpu [s]", "max_force_n"
/// -> "max force [N]".
std::string key_text(const std::string& key);

/// Returns the entries of an object that are neither objects nor lists of objects.
std::vector<std::pair<std::string, std::string>> facts_of(const Json& object);

}  // namespace palpate::report
