#pragma once
#include <optional>
#include <string>

#include "session/options.h"
#include "session/run_output.h"
#include "store/summary.h"

namespace palpate::session {

/// Outcome of a run that has no result.
struct Outcome {
  std::string word, message;
};

/// Returns the content of summary.json (docs/files.md).
/// @param outcome  replaces the outcome that the result implies
store::Summary summary_of(const loop::World& world, const RunOutput& ran, const Options& options,
                          const std::optional<Outcome>& outcome = {});

/// Writes summary.json and scene.toml into the folder of the run.
/// @pre the run writes files
void write_summary(const loop::World& world, const RunOutput& ran, const Options& options,
                   const std::optional<Outcome>& outcome = {});

}  // namespace palpate::session
