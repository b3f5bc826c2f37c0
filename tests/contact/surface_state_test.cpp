#include "contact/surface_state.h"

#include "surfaces.h"

using namespace contact_tests;

// A vertex of a skin is the same whether it was asked for alone or with all, and follows the nodes at each
// update.
TEST(SurfaceState, OneVertexIsAsAllAre) {
  SkinWorld world;
  contact::SurfaceState one(world.surface), all(world.surface);
  for (const double moved : {0.0, 0.25}) {
    world.state.q().tail(world.state.q().size() - 6).array() += moved;
    one.update(world.state.view());
    all.update(world.state.view());
    const Points& x = all.positions();
    double change = 0.0;
    for (int v = one.vertex_count() - 1; v >= 0; v -= 3) {
      EXPECT_EQ(one.position(v), Vec3(x.col(v)));
      change += (one.position(v) - world.vertices.col(v)).norm();
    }
    if (moved > 0.0) { EXPECT_GT(change, 0.1 * one.vertex_count()); }
    EXPECT_EQ(one.positions(), x) << "those that were asked for and the others";
  }
}
