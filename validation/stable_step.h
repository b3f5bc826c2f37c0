#pragma once
#include <string>

#include "palpate/loop/world.h"

namespace palpate::validation {

/// Largest of the steps `longest`, longest/2, longest/4, ... at which a fixed-step method amplifies no small
/// deviation from the World's state, by the eigenvalues of its step on the linearised equations.  Methods
/// that are A-stable take the longest.  Small scenes: matrices are dense.
double stable_step(const std::string& method, loop::World& world, double longest);

}  // namespace palpate::validation
