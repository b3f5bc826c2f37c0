#include "product/fem/peak_memory.h"

#include <fstream>
#include <limits>
#include <string>

#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace palpate::bench {
namespace {

/// Returns a line of /proc/self/status, in bytes.
double status_bytes(const std::string& requested) {
  std::ifstream status("/proc/self/status");
  std::string key;
  for (std::string rest; status >> key; std::getline(status, rest))
    if (key == requested) {
      double kib = 0.0;
      status >> kib;
      return 1024.0 * kib;
    }
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

PeakMemory::PeakMemory() {
#if defined(__GLIBC__)
  ::malloc_trim(0);  // Freed memory kept by the allocator would hide later allocations.
#endif
  std::ofstream("/proc/self/clear_refs") << "5";  // Resets the peak.
  before_ = status_bytes("VmRSS:");
}

double PeakMemory::bytes() const { return status_bytes("VmHWM:") - before_; }

}  // namespace palpate::bench
