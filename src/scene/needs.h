#pragma once
#include <string>
#include <vector>

#include "palpate/scene/description.h"

namespace palpate::scene {

/// Optional part of a scene: used or left out, with the reason.
struct Need {
  std::string part;
  bool used = false;
  std::string why;
};

/// Returns the optional parts and whether the scene uses them, from the description alone (`palpate
/// inspect`).
/// @param linear_solver  solver of its integrator (integrate::linear_solver_of); empty: the integrator is
///   explicit
std::vector<Need> needs(const Description& description, const std::string& linear_solver);

}  // namespace palpate::scene
