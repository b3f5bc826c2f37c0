// GPU clock, compared with the processor's clock.
#include "gl/timestamps.h"

#include <gtest/gtest.h>

#include "core/clock.h"
#include "gl/commands.h"
#include "gl/context.h"
#include "gl/framebuffer.h"
#include "palpate/core/error.h"

using namespace palpate;

// Clearing 16 million pixels repeatedly takes a positive time, which is no longer than the processor's wait.
TEST(Timestamps, LieBetweenTheCommands) {
  gl::Context::shared();
  gl::Timestamps at(4);
  gl::Framebuffer target(4096, 4096, {gl::Format::kR32ui}, gl::DepthBuffer::kNone);
  target.bind();
  target.clear(0, 1u);
  gl::finish("a first clear");
  const double start = wall_seconds();
  at.mark(0);
  at.mark(1);
  for (unsigned k = 0; k < 8; ++k) {
    target.clear(0, k);
    gl::finish("a clear");
  }
  at.mark(2);
  at.mark(3);
  gl::finish("clears");
  const double took = wall_seconds() - start, idle = at.seconds(0, 1), clearing = at.seconds(1, 2);
  if (at.seconds(0, 3) == 0.0) GTEST_SKIP() << "this driver has no clock";
  EXPECT_GT(clearing, 1e-4);
  EXPECT_GT(clearing, 4.0 * idle);
  EXPECT_LE(at.seconds(0, 3), took);
  EXPECT_NEAR(at.seconds(0, 3), idle + clearing + at.seconds(2, 3), 1e-9);
  EXPECT_EQ(at.seconds(2, 1), 0.0);  // reversed order of times
}

TEST(Timestamps, AreSomeAtLeast) {
  gl::Context::shared();
  EXPECT_THROW(gl::Timestamps(0), InternalError);
}
