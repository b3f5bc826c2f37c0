#include <gtest/gtest.h>

#include <cstdlib>

#include "malloc_count.h"
#include "proxy/decompose.h"
#include "proxy/proxy_set.h"
#include "shapes.h"

using namespace palpate;

TEST(Allocation, UpdatesOfProxiesAllocateNothing) {
#if PALPATE_CAN_COUNT
  LayeredModel model = bumpy_ball(1.0, 0.3, 10);
  model.proxies = proxy::decompose(model, {.count = 12});
  const long before_all = malloc_calls;
  proxy::ProxySet affine(model), rigid(model, {.follow = proxy::Follow::kRigid});
  EXPECT_GT(malloc_calls, before_all);  // the counter works
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
