#pragma once
#include <string>
#include <utility>
#include <vector>

namespace palpate::store {

/// Versions, libraries and machine that produced a result: enough to reproduce it.
struct Provenance {
  std::string version;  ///< Version of palpate.
  std::string commit;   ///< Commit, with `-dirty` for a modified checkout; "unknown" outside a checkout.
  std::string compiler;
  std::string build_type;
  std::vector<std::pair<std::string, std::string>> libraries;  ///< Name, version; callers may append.
  std::string cpu;
  int cores = 0;
  std::string system;       ///< Kernel.
  std::string started_utc;  ///< UTC time, 2007-03-22T10:00:00Z.
};
/// Returns the provenance of the running program; `started_utc` is the time of the call.
Provenance provenance();
/// Returns the version of palpate, without its commit.
std::string version();
/// Returns the version with its commit: "0.4.0 (1a2b3c4)".
std::string full_version();

}  // namespace palpate::store
