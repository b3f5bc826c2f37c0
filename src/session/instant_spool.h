#pragma once
#include <cstdio>
#include <string>

#include "session/instant.h"

namespace palpate::session {

/// Snapshots in the order of time, on disk, so that they can be read after a run without being kept in
/// memory.
class InstantSpool {
 public:
  /// @param folder  folder of an unnamed file that is removed with the spool
  /// @throws Error if no file can be created there
  explicit InstantSpool(const std::string& folder);
  ~InstantSpool();
  InstantSpool(const InstantSpool&) = delete;
  InstantSpool& operator=(const InstantSpool&) = delete;

  /// Appends a snapshot.  @throws Error if writing fails
  void append(const Instant& instant);
  int count() const { return count_; }

  /// Moves back to the first snapshot.
  void rewind();
  /// Reads the next snapshot; returns false after the last one.  @throws Error if reading fails
  bool next(Instant& out);

 private:
  [[noreturn]] void refuse(const char* what) const;

  std::string folder_;
  std::FILE* file_ = nullptr;
  int count_ = 0, read_ = 0;
};

}  // namespace palpate::session
