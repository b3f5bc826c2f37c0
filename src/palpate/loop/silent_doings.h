#pragma once
#include <string>

#include "palpate/dynamics/stepper.h"

namespace palpate::loop {

/// What a method did beside the steps that it was asked for (a step of h that was taken in parts is not one
/// of h), in words: "3 steps taken in 12 parts, the smallest 1/4, 2 matrices left to LU"; empty: nothing.
std::string silent_doings(const dynamics::StepperCounters& counters);

}  // namespace palpate::loop
