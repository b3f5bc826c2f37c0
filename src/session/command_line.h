#pragma once
#include <string>

#include "session/options.h"

namespace palpate::session {

/// Returns a word of the command line, quoted where a shell would split or expand it.
std::string quoted(const std::string& word);

/// Returns the command line that repeats a run; of a scene that was made from a text, for the scene.toml in
/// the folder of the run.
std::string command_of(const Options& options);

}  // namespace palpate::session
