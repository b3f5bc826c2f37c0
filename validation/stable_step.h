#pragma once
#include <string>

#include "palpate/loop/world.h"

namespace palpate::validation {

/// Returns the largest of the steps `longest`, longest/2, longest/4, ... at which a fixed-step method
/// amplifies no small deviation from the World's state, by the eigenvalues of its step on the linearised
/// equations. For methods that are not explicit it is the longest. Matrices are dense, for small scenes.
double stable_step(const std::string& method, loop::World& world, double longest);

}  // namespace palpate::validation
