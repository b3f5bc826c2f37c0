#pragma once
#include <string>

#include "run.h"

namespace palpate::cli {

/// Returns a word of the command line, quoted where a shell would split or expand it.
std::string quoted(const std::string& word);

/// Returns the command line that repeats a run.
std::string command_of(const RunArguments& arguments);

}  // namespace palpate::cli
