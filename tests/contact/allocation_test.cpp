// After the first queries, contact allocates no more memory: query, force and tangent reuse their buffers.
#include "malloc_count.h"
#include "touching.h"

using namespace contact_tests;

TEST(ContactMemory, NothingIsAllocatedAfterTheFirstQueries) {
#if !PALPATE_CAN_COUNT
  GTEST_SKIP() << "a sanitizer brings its own malloc";
#else
  int checked = 0;
  for (const TouchingKind& kind : touching_kinds())
    for (const double friction : {0.0, 0.3}) {
      Touching at = kind.make();
      contact::ContactForce term;
      for (const auto& frame : at.frames) term.add_frame(frame);
      ContactSpec law;
      law.stiffness_pa_m = 1e4;
      law.friction = friction;
      term.add_pair(std::move(at.source), law);
      const int size = at.state.layout().u_size;
      VecX f = VecX::Zero(size), x = VecX::Ones(size), y = VecX::Zero(size);
      const auto view = [&] { return at.state.view(); };
      term.refresh(view());
      dynamics::BorderedMatrix A = step_matrix(term, at.state, 1.0, 0.5);
      long counts[4] = {};
      for (int i = 0; i < 6; ++i) {
        // moves slightly back and forth, so that the same faces collide
        at.state.q().tail(at.state.q().size() - 6).array() += i % 2 ? 1e-7 : -1e-7;
        const auto counted = [&](int what, const auto& call) {
          const long before = malloc_calls;
          call();
          if (i >= 4) counts[what] += malloc_calls - before;
        };
        counted(0, [&] { term.refresh(view()); });
        counted(1, [&] { term.add_force(view(), f); });
        counted(2, [&] { term.add_tangent(view(), 1.0, 0.5, A); });
        counted(3, [&] { term.apply_tangent(view(), 1.0, 0.5, x, y); });
      }
      EXPECT_GT(term.samples().size(), 20u) << kind.name;
      if (!kind.image) {  // in image space the driver's allocations would be counted
        EXPECT_EQ(counts[0], 0) << kind.name << ": query, friction " << friction;
      }
      EXPECT_EQ(counts[1], 0) << kind.name << ": force, friction " << friction;
      EXPECT_EQ(counts[2], 0) << kind.name << ": tangent, friction " << friction;
      EXPECT_EQ(counts[3], 0) << kind.name << ": product, friction " << friction;
      ++checked;
    }
  EXPECT_EQ(checked, 2 * static_cast<int>(touching_kinds().size()));
#endif
}
