#pragma once
#include <string>
#include <string_view>

namespace palpate::gl {

/// Linked programs kept on disk, as the driver's own binaries: in $XDG_CACHE_HOME/palpate/shaders, else
/// ~/.cache/palpate/shaders; nowhere where neither is set.  They are a matter of speed alone: whatever is
/// missing, damaged, not writable or refused by the driver is compiled again.

/// What a program is made of; a driver and a version of it have each their own binaries.
struct ProgramKey {
  std::string text;  ///< driver, version and sources
};
ProgramKey program_key(std::string_view sources);  ///< of the current context

/// Whether the program `id` could be had from the cache.  Counts "gl.program_from_cache".
bool load_program(unsigned id, const ProgramKey& key);
/// Keeps a linked program that was made with GL_PROGRAM_BINARY_RETRIEVABLE_HINT.
void keep_program(unsigned id, const ProgramKey& key);

}  // namespace palpate::gl
