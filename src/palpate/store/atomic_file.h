#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace palpate::store {

/// Writes a small file whole or not at all: a temporary file beside it, then a rename.
/// A reader never sees half of it.
void write_atomically(const std::string& path, std::string_view content);

/// The same, and on the disk when it returns: a loss of power leaves the old file or the new one.
void write_durably(const std::string& path, std::string_view content);

/// What was written to a file so far is on the disk when it returns.  @throws Error where the disk refuses
void bring_to_disk(const std::string& path);

/// Cuts a file off behind so many bytes.  @throws Error where it is not there or shorter
void cut_to(const std::string& path, std::int64_t bytes);

std::string read_file(const std::string& path);  ///< @throws Error

}  // namespace palpate::store
