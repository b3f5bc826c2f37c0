#pragma once
#include <string>

/// Memory that this process can still obtain from the machine.
namespace palpate {

/// Available memory and the limit that determines it.
struct AvailableMemory {
  double bytes = 0.0;  ///< Infinity where no limit is known.
  /// "MemAvailable of /proc/meminfo", "the limit of the control group ...", "ulimit -v".
  std::string limited_by;
};

/// Returns the minimum of: memory that the kernel can provide without swapping, memory left in the control
/// groups of this process, and its limits of address space (ulimit -v) and of data (ulimit -d).  Returns
/// infinity where none can be read.
/// @param root       root of the files read: "/", or a folder with proc/ and sys/ for tests
/// @param addresses  bytes of address space that will be reserved but hardly filled; counted against the last
///   two limits only
AvailableMemory available_memory(const std::string& root = "/", double addresses = 0.0);

/// Whether a limit of address space or data is in force, or the kernel does not overcommit
/// (vm.overcommit_memory = 2): libraries may then be denied memory that they reserve without filling.
bool addresses_are_limited();

/// Formats a size: "1.2 GiB", "340 MiB".
std::string memory_text(double bytes);

/// Rejects a computation that does not fit into memory, before it allocates.  A non-empty environment
/// variable PALPATE_BEYOND_MEMORY disables the check (--beyond-memory sets it).
/// @param what       for the message: `scene "head": 33000 nodes and 156000 tetrahedra`
/// @param needed     estimated memory [bytes]
/// @param parts      breakdown of `needed`, for the message; may be empty
/// @param advice     remedy that needs less memory
/// @param addresses  further address space, as in available_memory() [bytes]
/// @throws Error with all figures
void refuse_beyond_memory(const std::string& what, double needed, const std::string& parts,
                          const std::string& advice, double addresses = 0.0);

}  // namespace palpate
