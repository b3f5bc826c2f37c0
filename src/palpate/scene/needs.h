#pragma once
#include <string>
#include <vector>

#include "palpate/scene/description.h"

namespace palpate::scene {

/// One optional part: in use or left out, and why.
struct Need {
  std::string part;
  bool used = false;
  std::string why;
};

/// What a scene needs and what it leaves out, from the description alone (`palpate inspect`).
/// @param linear_solver  that its integrator uses (integrate::linear_solver_of); empty: the integrator is
///   explicit
std::vector<Need> needs(const Description& description, const std::string& linear_solver);

}  // namespace palpate::scene
