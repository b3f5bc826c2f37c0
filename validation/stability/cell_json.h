#pragma once
#include <nlohmann/json.hpp>

#include "stability.h"

namespace palpate::stability {

/// Encodes a cell; a number that is not finite becomes null, as JSON has no NaN.
nlohmann::ordered_json cell_to_json(const StabilityCell& cell);
StabilityCell cell_from_json(const nlohmann::json& json);

}  // namespace palpate::stability
