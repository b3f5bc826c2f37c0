#pragma once
#include <atomic>
#include <nlohmann/json.hpp>

#include "palpate/scene/description.h"

namespace palpate::study {

using Json = nlohmann::ordered_json;

/// Runs a scene in this process.
/// @param repeats  number of runs; their figures must be equal
/// @return "status" ("ok", "failed", "refused", "out of time"), "reason", "figures" (bitwise reproducible by
///   the same program), "times" (medians [s], peak memory [MiB])
/// @throws std::bad_alloc, and InternalError for a defect of palpate
Json run_scene(const scene::Description& description, int repeats, const std::atomic<bool>& out_of_time);

}  // namespace palpate::study
