#pragma once
#include <string>
#include <vector>

#include "palpate/core/archive.h"

namespace palpate::store {

/// One checkpoint of a run: all that the run needs to go on from there as if it had never stopped.
struct Checkpoint {
  std::string version;       ///< of palpate, as version() says
  double time_s = 0.0;       ///< simulated [s]
  std::string scene_source;  ///< the effective TOML
  Archive::Values values;    ///< state of the run, by name
};

/// Writes a checkpoint whole or not at all, in HDF5: into a temporary file that is brought to the disk and
/// then takes the place of the one before.  A kill or a loss of power at any instant leaves the old one or
/// the new one.
/// @throws Error where the disk refuses
void write_checkpoint(const std::string& path, const Checkpoint& checkpoint);

/// @throws Error for a file that is none, is cut short, or whose content is not what was written
Checkpoint read_checkpoint(const std::string& path);

}  // namespace palpate::store
