#pragma once
#include <atomic>
#include <cstddef>

// Counts every call of malloc in this program (operator new and Eigen end there): include it in one file of a
// test. Sanitizers replace malloc: the test then skips.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(__GLIBC__)
#define PALPATE_CAN_COUNT 0
#else
#define PALPATE_CAN_COUNT 1
static std::atomic<long> malloc_calls{0};
extern "C" void* __libc_malloc(std::size_t);
extern "C" void* malloc(std::size_t size) {
  malloc_calls.fetch_add(1, std::memory_order_relaxed);
  return __libc_malloc(size);
}
#endif
