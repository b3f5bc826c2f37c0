#include "core/memory.h"

#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>

#include "palpate/core/error.h"

namespace palpate {
namespace {
namespace fs = std::filesystem;

std::optional<double> number_in(const fs::path& file) {
  std::ifstream in(file);
  double out = 0.0;
  if (!(in >> out)) return {};  // "max", or no such file.
  return out;
}

std::optional<double> of_meminfo(const fs::path& root) {
  std::ifstream in(root / "proc/meminfo");
  std::string key;
  double kib = 0.0;
  for (std::string rest; in >> key >> kib && std::getline(in, rest);)
    if (key == "MemAvailable:") return 1024.0 * kib;
  return {};
}

/// Reads a figure of memory.stat: file pages, which the kernel can reclaim.
double reclaimable(const fs::path& group, const char* name) {
  std::ifstream in(group / "memory.stat");
  std::string key;
  for (double bytes = 0.0; in >> key >> bytes;)
    if (key == name) return bytes;
  return 0.0;
}

void take(AvailableMemory& least, std::optional<double> bytes, const std::string& limited_by) {
  if (bytes && *bytes < least.bytes) least = {std::max(0.0, *bytes), limited_by};
}

/// Applies the limits of the control groups.  Version 2, the group and all above it: memory.max,
/// memory.current. Version 1: memory.limit_in_bytes.
void take_groups(AvailableMemory& least, const fs::path& root) {
  std::ifstream in(root / "proc/self/cgroup");
  for (std::string line; std::getline(in, line);) {  // "0::/user.slice/..." or "9:memory:/..."
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    const bool unified = controllers.empty();
    if (!unified && controllers != "memory") continue;
    const fs::path top = root / (unified ? "sys/fs/cgroup" : "sys/fs/cgroup/memory");
    fs::path group = top / fs::path(line.substr(second + 1)).relative_path();
    for (;; group = group.parent_path()) {
      const auto most = number_in(group / (unified ? "memory.max" : "memory.limit_in_bytes")),
                 used = number_in(group / (unified ? "memory.current" : "memory.usage_in_bytes"));
      if (most && used)
        take(least, *most - *used + reclaimable(group, unified ? "inactive_file" : "total_inactive_file"),
             "the limit of the control group " + group.string());
      if (group == top || group.native().size() <= top.native().size()) break;
    }
  }
}

bool is_limited(__rlimit_resource_t resource, rlimit& most) {
  return ::getrlimit(resource, &most) == 0 && most.rlim_cur != RLIM_INFINITY;
}

/// Applies the limits of address space and data.  proc(5), /proc/self/statm: the first number is the size of
/// the address space, the sixth the size of data [pages].
void take_addresses(AvailableMemory& least, const fs::path& root, double addresses) {
  double pages[6] = {};
  std::ifstream in(root / "proc/self/statm");
  for (double& number : pages)
    if (!(in >> number)) number = 0.0;
  const auto page = static_cast<double>(::sysconf(_SC_PAGESIZE));
  rlimit most{};
  if (is_limited(RLIMIT_AS, most))
    take(least, static_cast<double>(most.rlim_cur) - page * pages[0] - addresses,
         "the limit on address space, ulimit -v");
  if (is_limited(RLIMIT_DATA, most))
    take(least, static_cast<double>(most.rlim_cur) - page * pages[5] - addresses,
         "the limit on data, ulimit -d");
}

}  // namespace

AvailableMemory available_memory(const std::string& root, double addresses) {
  AvailableMemory least{std::numeric_limits<double>::infinity(), "nothing"};
  take(least, of_meminfo(root), "MemAvailable of /proc/meminfo");
  take_groups(least, root);
  take_addresses(least, root, addresses);
  return least;
}

bool addresses_are_limited() {
  constexpr double kNeverMore = 2.0;
  rlimit most{};
  return is_limited(RLIMIT_AS, most) || is_limited(RLIMIT_DATA, most) ||
         number_in("/proc/sys/vm/overcommit_memory") == kNeverMore;
}

std::string memory_text(double bytes) {
  constexpr double kMiB = 1024.0 * 1024.0, kGiB = 1024.0 * kMiB;
  return bytes < kGiB ? fmt::format("{:.0f} MiB", bytes / kMiB) : fmt::format("{:.1f} GiB", bytes / kGiB);
}

void refuse_beyond_memory(const std::string& what, double needed, const std::string& parts,
                          const std::string& advice, double addresses) {
  if (const char* beyond = std::getenv("PALPATE_BEYOND_MEMORY"); beyond && *beyond != '\0') return;
  const AvailableMemory available = available_memory("/", addresses);
  if (needed <= available.bytes) return;
  const std::string libraries =
      addresses > 0.0 && available.limited_by.starts_with("the limit on")
          ? fmt::format(" after reserving {} of address space for libraries", memory_text(addresses))
          : "";
  fail(
      "{} need about {} of memory{}, but only {} are available{} ({}); {}, or continue anyway with "
      "--beyond-memory",
      what, memory_text(needed), parts.empty() ? "" : " (" + parts + ")", memory_text(available.bytes),
      libraries, available.limited_by, advice);
}

}  // namespace palpate
