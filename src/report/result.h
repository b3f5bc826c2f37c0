#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "json.h"
#include "report/page.h"

namespace palpate::report {

/// A folder that a command wrote: what kinds of results are in it, of what, and what they answer.
struct Result {
  std::filesystem::path dir;
  std::vector<std::string> kinds;  ///< "Run", "Comparison", ... as they follow one another on the page
  std::string of;                  ///< the scene; empty where there is none
  Json summary = Json::object();   ///< summary.json
  std::vector<Answer> answers;

  std::string title() const;         ///< "Run and comparison: press-ball"
  std::string first_answer() const;  ///< a sentence; empty where there is none
};

/// @throws Error when the folder is none, or holds no results, or one of its files is broken
Result open_result(const std::filesystem::path& dir);

/// All that the result holds, its answers first.
void add_result(Page& page, const Result& result);

}  // namespace palpate::report
