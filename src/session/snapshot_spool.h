#pragma once
#include <cstdio>
#include <string>

#include "session/world_snapshot.h"

namespace palpate::session {

/// Snapshots in the order of time, on disk, so that they can be read after a run without being kept in
/// memory.
class SnapshotSpool {
 public:
  /// @param folder  folder of an unnamed file that is removed with the spool
  /// @throws Error if no file can be created there
  explicit SnapshotSpool(const std::string& folder);
  ~SnapshotSpool();
  SnapshotSpool(const SnapshotSpool&) = delete;
  SnapshotSpool& operator=(const SnapshotSpool&) = delete;

  /// Appends a snapshot.  @throws Error if writing fails
  void append(const WorldSnapshot& snapshot);
  int count() const { return count_; }

  /// Moves back to the first snapshot.
  void rewind();
  /// Reads the next snapshot; returns false after the last one.  @throws Error if reading fails
  bool next(WorldSnapshot& out);

 private:
  [[noreturn]] void refuse(const char* what) const;

  std::string folder_;
  std::FILE* file_ = nullptr;
  int count_ = 0, read_ = 0;
};

}  // namespace palpate::session
