#pragma once
#include <string>

#include "palpate/scene/description.h"

namespace palpate::loop {

/// The scene's text without its [compare] tables: what is compared with what does not change what one run
/// gives, so that a ladder can be added to a study.  A text with multi-line strings stays as it is.
std::string without_compare(const std::string& source);

/// Version and commit of this palpate.  A commit does not name sources that were changed since: there, size
/// and time of the program and of its own libraries do.
const std::string& made_by();

/// Name of the result of one run: a hash of the scene's text, the bytes of the mesh files that it names, the
/// simulated time, this palpate, and `more`.
std::string result_key(const scene::Description& description, const std::string& more);

}  // namespace palpate::loop
