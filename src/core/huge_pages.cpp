#include "core/huge_pages.h"

#include <cstdint>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace palpate {

void prefer_huge_pages([[maybe_unused]] const void* memory, [[maybe_unused]] std::size_t bytes) {
#if defined(__linux__) && defined(MADV_HUGEPAGE)
  constexpr std::uintptr_t kPage = 2u << 20;
  const auto first = (reinterpret_cast<std::uintptr_t>(memory) + kPage - 1) / kPage * kPage;
  const auto last = (reinterpret_cast<std::uintptr_t>(memory) + bytes) / kPage * kPage;
  if (first >= last) return;
  void* begin = reinterpret_cast<void*>(first);
  ::madvise(begin, last - first, MADV_HUGEPAGE);  // For pages not yet mapped.
  // MADV_COLLAPSE of Linux 6.1; C libraries define the name later, and older kernels reject it.
  constexpr int kCollapse = 25;
  ::madvise(begin, last - first, kCollapse);  // For pages already mapped.
#endif
}

}  // namespace palpate
