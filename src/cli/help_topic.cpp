#include "help_topic.h"

#include <algorithm>

namespace palpate::cli {
namespace {

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Returns the name that the word begins, or is the singular of; empty where there is none, or several.
std::string completion(const std::vector<std::string>& names, const std::string& word) {
  for (const char* plural : {"s", "es"})
    if (contains(names, word + plural)) return word + plural;
  if (word.ends_with('y'))
    if (const std::string plural = word.substr(0, word.size() - 1) + "ies"; contains(names, plural))
      return plural;
  const std::vector<std::string> begin = beginning_with(word, names);
  return begin.size() == 1 ? begin.front() : "";
}

}  // namespace

std::vector<std::string> beginning_with(const std::string& text, const std::vector<std::string>& names) {
  std::vector<std::string> out;
  for (const std::string& name : names)
    if (name.starts_with(text) && !contains(out, name)) out.push_back(name);
  return out;
}

bool complete_topic(const std::vector<std::string>& pages, const std::vector<std::string>& commands,
                    std::string& word) {
  if (word.empty()) return false;
  if (contains(pages, word)) return true;
  if (contains(commands, word)) return false;
  if (const std::string page = completion(pages, word); !page.empty()) {
    word = page;
    return true;
  }
  // An ambiguous word is not completed to a command.
  if (!beginning_with(word, pages).empty()) return false;
  if (const std::string command = completion(commands, word); !command.empty()) word = command;
  return false;
}

}  // namespace palpate::cli
