#pragma once
#include <string>
#include <string_view>

namespace palpate::gl {

/// Cache of linked programs on disk, as driver-specific binaries: in $XDG_CACHE_HOME/palpate/shaders, else
/// ~/.cache/palpate/shaders; none where neither is set.  It only affects speed: programs that are missing,
/// damaged or rejected by the driver are compiled again.

/// Key of a program.  Each driver and driver version has separate binaries.
struct ProgramKey {
  std::string text;  ///< Driver, version and sources.
};
ProgramKey program_key(std::string_view sources);  ///< For the current context.

/// Loads program `id` from the cache; returns whether that succeeded.  Counts "gl.program_from_cache".
bool load_program(unsigned id, const ProgramKey& key);
/// Stores a linked program that was made with GL_PROGRAM_BINARY_RETRIEVABLE_HINT.
void keep_program(unsigned id, const ProgramKey& key);

}  // namespace palpate::gl
