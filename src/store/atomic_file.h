#pragma once
#include <cstdint>
#include <string>
#include <string_view>

#include "store/content_hash.h"

namespace palpate::store {

/// Writes a small file completely or not at all: writes a temporary file in the same folder, then renames it.
/// A reader never sees an incomplete file.
void write_atomically(const std::string& path, std::string_view content);

/// Checks that write_atomically() could create a file of this name, ahead of a long computation of its
/// content.  Leaves nothing behind.  @throws Error where it could not
void check_can_write(const std::string& path);

/// Writes as write_atomically() does, and returns only when the content is on disk.  After a loss of power,
/// the old or the new file is present.
void write_durably(const std::string& path, std::string_view content);

/// Brings the data written to a file so far to the disk (fsync).  @throws Error where that fails
void sync_file(const std::string& path);

/// Checks a file that a run resumes.  @throws Error where it is missing, or shorter than at the checkpoint
void check_reaches(const std::string& path, std::int64_t bytes);
/// Truncates a file to that many bytes.  @throws Error where it is missing or shorter
void truncate_file(const std::string& path, std::int64_t bytes);

/// Checks that a file to be resumed contains the data that its run had written by the checkpoint.
/// @param path  for messages
/// @param found, written  hashes of the content now and at the checkpoint
/// @throws Error where they differ
void check_content(const std::string& path, const ContentHash& found, const std::string& written);

/// Returns the content of a file.  @throws Error where it cannot be read
std::string read_file(const std::string& path);

}  // namespace palpate::store
