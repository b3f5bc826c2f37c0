#pragma once
#include <cstdio>
#include <string>

#include "instant.h"

namespace palpate::cli {

/// Instants in the order of time, on disk: a run is looked at behind it without being kept in memory.
class InstantSpool {
 public:
  /// @param folder  for a file that has no name, and is gone when the spool is
  /// @throws Error where no file can be made there
  explicit InstantSpool(const std::string& folder);
  ~InstantSpool();
  InstantSpool(const InstantSpool&) = delete;
  InstantSpool& operator=(const InstantSpool&) = delete;

  /// @throws Error where the disk refuses it
  void append(const Instant& instant);
  int count() const { return count_; }

  /// The next one read is the first.
  void rewind();
  /// False behind the last.  @throws Error where the disk refuses it
  bool next(Instant& out);

 private:
  [[noreturn]] void refuse(const char* what) const;

  std::string folder_;
  std::FILE* file_ = nullptr;
  int count_ = 0, read_ = 0;
};

}  // namespace palpate::cli
