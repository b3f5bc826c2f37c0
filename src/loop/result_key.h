#pragma once
#include <string>

#include "palpate/scene/description.h"

namespace palpate::loop {

/// Returns the scene's text without its tables [compare] and [view], which do not affect the result of a
/// single run, so that a refinement sequence can be added to a study. A text with multi-line strings is
/// returned unchanged.
std::string without_compare(const std::string& source);

/// Returns version and commit of this build. For modified or unknown sources the commit is not unique, so
/// size and modification time of the program and the palpate libraries are appended.
const std::string& made_by();

/// Returns the key of the result of one run: a hash of the scene's text, the bytes of its mesh files and
/// recordings, the simulated time, this build, and `more`.
std::string result_key(const scene::Description& description, const std::string& more);

}  // namespace palpate::loop
