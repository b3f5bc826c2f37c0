#pragma once
#include <string>

/// What this process may still take of the machine's memory.
namespace palpate {

struct AvailableMemory {
  double bytes = 0.0;
  std::string
      limited_by;  ///< "MemAvailable of /proc/meminfo", "the limit of the control group ...", "ulimit -v"
};

/// The least of: memory that the kernel can give without swapping, what the control groups of this process
/// have left, and its own limit of addresses.  Where nothing of it can be read, infinity.
/// @param root  of the files that say so: "/", or a folder with proc/ and sys/ for tests
AvailableMemory available_memory(const std::string& root = "/");

/// "1.2 GiB", "340 MiB"
std::string memory_text(double bytes);

/// Refuses what does not fit, before it takes anything.  The environment variable PALPATE_BEYOND_MEMORY, not
/// empty, lets it pass (--beyond-memory sets it).
/// @param what    for the message: `scene "head": 33000 nodes and 156000 tetrahedra`
/// @param needed  [bytes], about
/// @param parts   what they are for, for the message; may be empty
/// @param advice  what needs less
/// @throws Error with both figures
void refuse_beyond_memory(const std::string& what, double needed, const std::string& parts,
                          const std::string& advice);

}  // namespace palpate
