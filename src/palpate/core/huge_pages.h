#pragma once
#include <cstddef>
#include <vector>

namespace palpate {

/// Asks the system to back this memory by huge pages (2 MiB on x86) as far as whole ones lie in it; contents
/// stay.  A processor's TLB holds some thousand translations (of 4 KiB each: about 16 MiB), so arrays beyond
/// that pay a walk through the page tables at nearly every jump.  Worth it for arrays that live long; nothing
/// happens where the system has none to give.
void prefer_huge_pages(const void* memory, std::size_t bytes);

template <class T, class A>
void prefer_huge_pages(const std::vector<T, A>& v) {
  prefer_huge_pages(v.data(), v.capacity() * sizeof(T));
}

}  // namespace palpate
