#pragma once
#include <string>

/// What this process may still take of the machine's memory.
namespace palpate {

struct AvailableMemory {
  double bytes = 0.0;
  /// "MemAvailable of /proc/meminfo", "the limit of the control group ...", "ulimit -v"
  std::string limited_by;
};

/// The least of: memory that the kernel can give without swapping, what the control groups of this process
/// have left, and its own limits of addresses (ulimit -v) and of data (ulimit -d).  Where nothing of it can
/// be read, infinity.
/// @param root       of the files that say so: "/", or a folder with proc/ and sys/ for tests
/// @param addresses  bytes of addresses that will be taken and hardly filled: the last two limits alone count
///   them
AvailableMemory available_memory(const std::string& root = "/", double addresses = 0.0);

/// Whether a limit of addresses or of data is in force, or the kernel promises no more than it has
/// (vm.overcommit_memory = 2): then libraries may be denied memory that they will not fill.
bool addresses_are_limited();

/// "1.2 GiB", "340 MiB"
std::string memory_text(double bytes);

/// Refuses what does not fit, before it takes anything.  The environment variable PALPATE_BEYOND_MEMORY, not
/// empty, lets it pass (--beyond-memory sets it).
/// @param what       for the message: `scene "head": 33000 nodes and 156000 tetrahedra`
/// @param needed     [bytes], about
/// @param parts      what they are for, for the message; may be empty
/// @param advice     what needs less
/// @param addresses  beside them, as of available_memory()
/// @throws Error with all figures
void refuse_beyond_memory(const std::string& what, double needed, const std::string& parts,
                          const std::string& advice, double addresses = 0.0);

}  // namespace palpate
