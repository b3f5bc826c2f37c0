#pragma once
#include <functional>
#include <string>

namespace palpate::model {

/// Called with how far the step at hand is, in [0, 1]; may be empty.
using Progress = std::function<void(double fraction)>;

}  // namespace palpate::model
