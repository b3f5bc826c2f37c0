#pragma once
#include <string>
#include <utility>
#include <vector>

namespace palpate::store {

/// Versions, libraries and machine that made a result: enough to make it again.
struct Provenance {
  std::string version;  ///< of palpate
  std::string commit;   ///< with `-dirty` where sources were changed; "unknown" outside a checkout
  std::string compiler;
  std::string build_type;
  std::vector<std::pair<std::string, std::string>> libraries;  ///< name, version; a caller may add its own
  std::string cpu;
  int cores = 0;
  std::string system;       ///< kernel
  std::string started_utc;  ///< 2007-03-22T10:00:00Z
};
Provenance provenance();
/// That of palpate alone.
std::string version();
/// With its commit: "0.4.0 (1a2b3c4)".
std::string full_version();

}  // namespace palpate::store
