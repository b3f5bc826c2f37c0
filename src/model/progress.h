#pragma once
#include <functional>
#include <string>

namespace palpate::model {

/// Receives the completed fraction of the current step, in [0, 1]; may be empty.
using Progress = std::function<void(double fraction)>;

}  // namespace palpate::model
