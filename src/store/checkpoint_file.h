#pragma once
#include <string>
#include <vector>

#include "palpate/core/archive.h"

namespace palpate::store {

/// Checkpoint of a run: all data that the run needs to resume as if it had never stopped.
struct Checkpoint {
  std::string version;       ///< Version of palpate, as version() returns it.
  double time_s = 0.0;       ///< Simulated time [s].
  std::string scene_source;  ///< Effective scene, as TOML.
  Archive::Values values;    ///< State of the run, by name.
};

/// Writes a checkpoint atomically, in HDF5: into a temporary file that is brought to the disk and then
/// replaces the previous one.  A kill or a loss of power at any time leaves either the old or the new
/// checkpoint.
/// @throws Error where writing fails
void write_checkpoint(const std::string& path, const Checkpoint& checkpoint);

/// Reads a checkpoint.  @throws Error for a file that is no checkpoint, is truncated, or whose content
/// differs from the content written
Checkpoint read_checkpoint(const std::string& path);

}  // namespace palpate::store
