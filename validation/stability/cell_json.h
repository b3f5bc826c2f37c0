#pragma once
#include <nlohmann/json.hpp>

#include "stability.h"

namespace palpate::stability {

/// A number that is not finite is null: JSON has no NaN.
nlohmann::ordered_json cell_to_json(const StabilityCell& cell);
StabilityCell cell_from_json(const nlohmann::json& json);

}  // namespace palpate::stability
