#pragma once
#include "palpate/study/validation.h"

/// One function a case, one file a function; registry.cpp puts them in order.
namespace palpate::validation {

using study::Measurement;
using study::ValidationCase;

}  // namespace palpate::validation
