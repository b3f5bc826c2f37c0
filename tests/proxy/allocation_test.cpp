#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>

#include "palpate/proxy/decompose.h"
#include "palpate/proxy/proxy_set.h"
#include "shapes.h"

// Counts every call of malloc in this program (operator new and Eigen end there).  Sanitizers bring their own malloc: then the test skips.
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

using namespace palpate;

TEST(Allocation, UpdatesOfProxiesAllocateNothing) {
#if PALPATE_CAN_COUNT
  LayeredModel model = bumpy_ball(1.0, 0.3, 10);
  model.proxies = proxy::decompose(model, {.count = 12});
  const long before_all = malloc_calls;
  proxy::ProxySet affine(model), rigid(model, {.follow = proxy::Follow::kRigid});
  EXPECT_GT(malloc_calls, before_all);  // the counter counts
  Points nodes = 1.3 * model.tets.nodes;
  nodes.row(0) *= -0.01;
  const long before = malloc_calls;
  affine.update(nodes);
  rigid.update(nodes);
  EXPECT_EQ(malloc_calls - before, 0);
#else
  GTEST_SKIP() << "this build's malloc cannot be counted";
#endif
}
