#pragma once
#include <string>

#include "palpate/dynamics/stepper.h"

namespace palpate::loop {

/// Describes the fallbacks of a method, in addition to the requested steps (a step h that was subdivided is
/// not one step of h): "3 steps taken in 12 parts, the smallest 1/4, 2 matrices left to LU"; empty: none.
std::string describe_fallbacks(const dynamics::StepperCounters& counters);

}  // namespace palpate::loop
