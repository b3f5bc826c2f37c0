#pragma once
#include <cstddef>
#include <vector>

namespace palpate {

/// Requests huge pages (2 MiB on x86) for the whole pages inside this memory; contents are kept.  A
/// processor's TLB holds some thousand translations (4 KiB each: about 16 MiB), so random access to larger
/// arrays costs a page walk nearly every time.  Worthwhile for long-lived arrays; no effect where the system
/// has no huge pages available.
void prefer_huge_pages(const void* memory, std::size_t bytes);

/// Requests huge pages for the capacity of a vector.
template <class T, class A>
void prefer_huge_pages(const std::vector<T, A>& v) {
  prefer_huge_pages(v.data(), v.capacity() * sizeof(T));
}

}  // namespace palpate
