#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "json.h"
#include "report/first_view.h"
#include "report/page.h"

namespace palpate::report {

/// Folder that a command wrote: the kinds of results in it, their scene, and their answers.
struct Result {
  std::filesystem::path dir;       ///< The folder
  std::vector<std::string> kinds;  ///< Kinds in the order of the page: "Run", "Comparison", ...
  std::string of;                  ///< Name of the scene; empty if there is none
  Json summary = Json::object();   ///< Content of summary.json
  std::vector<Answer> answers;

  std::string title() const;         ///< Title, as "Run and comparison: press-ball"
  std::string first_answer() const;  ///< First answer as a sentence; empty if there is none
};

/// Reads the results in a folder.
/// @throws Error if it is no folder, contains no results, or one of its files is invalid
Result open_result(const std::filesystem::path& dir);

/// Adds all of the result to the page, its picture and its answers first.
/// @param picture  whether the picture is added, if there is one
void add_result(Page& page, const Result& result, const FirstView& view, bool picture = true);

}  // namespace palpate::report
