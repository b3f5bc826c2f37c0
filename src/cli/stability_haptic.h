#pragma once
#include "cli/stability_options.h"

namespace palpate::cli {

/// Finds the stiffest wall that the haptic loop of a scene renders stably (--haptic).
/// @return the exit status
int stability_haptic(const StabilityArguments& arguments);

}  // namespace palpate::cli
