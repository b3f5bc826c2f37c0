#pragma once
#include <atomic>
#include <nlohmann/json.hpp>

#include "palpate/scene/description.h"

namespace palpate::study {

using Json = nlohmann::ordered_json;

/// Runs a scene in this process.
/// @param repeats  how often; its figures must come out the same each time
/// @return "status" ("ok", "failed", "refused", "out of time"), "reason", "figures" (what the same program
///   finds again to the last bit), "times" (medians [s], peak memory [MiB])
/// @throws std::bad_alloc, and whatever is a defect of palpate
Json run_scene(const scene::Description& description, int repeats, const std::atomic<bool>& out_of_time);

}  // namespace palpate::study
