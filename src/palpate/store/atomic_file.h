#pragma once
#include <cstdint>
#include <string>
#include <string_view>

#include "palpate/store/content_hash.h"

namespace palpate::store {

/// Writes a small file whole or not at all: a temporary file beside it, then a rename.
/// A reader never sees half of it.
void write_atomically(const std::string& path, std::string_view content);

/// Whether write_atomically() would find a folder that takes a file of this name: for what is computed for
/// long before it is written.  Leaves nothing behind.  @throws Error where it would not
void check_can_write(const std::string& path);

/// As write_atomically(), and on the disk when it returns: a loss of power leaves the old file or the new
/// one.
void write_durably(const std::string& path, std::string_view content);

/// What was written to a file so far is on the disk when it returns.  @throws Error where the disk refuses
void bring_to_disk(const std::string& path);

/// @throws Error where a file that a run goes on with is not there, or has fewer bytes than at its checkpoint
void check_reaches(const std::string& path, std::int64_t bytes);
/// Cuts a file off behind so many bytes.  @throws Error where it is not there or shorter
void cut_to(const std::string& path, std::int64_t bytes);

/// For a run that goes on: @throws Error where a file does not hold what its run had written by the
/// checkpoint
/// @param found, written  of its content
void check_content(const std::string& path, const ContentHash& found, const std::string& written);

std::string read_file(const std::string& path);  ///< @throws Error

}  // namespace palpate::store
