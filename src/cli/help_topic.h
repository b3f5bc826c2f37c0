#pragma once
#include <string>
#include <vector>

namespace palpate::cli {

/// Returns the names that begin with a text, each once.
std::vector<std::string> beginning_with(const std::string& text, const std::vector<std::string>& names);

/// Completes a word of `palpate help` to a page or a command: the name itself, the only name that begins with
/// it ("device" for "devices"), or the name that it is the singular of.  Pages come before commands.
/// @param word  completed in place; unchanged where it is unknown or ambiguous
/// @return whether it is a page
bool complete_topic(const std::vector<std::string>& pages, const std::vector<std::string>& commands,
                    std::string& word);

}  // namespace palpate::cli
