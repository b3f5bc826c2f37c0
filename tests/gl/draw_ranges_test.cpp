// Ranges of faces drawn at once: position of each vertex, number of each face.
#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <array>
#include <cstring>

#include "gl/buffer.h"
#include "gl/commands.h"
#include "gl/context.h"
#include "gl/framebuffer.h"
#include "gl/mapped_buffer.h"
#include "gl/program.h"

using namespace palpate;

namespace {

/// Format read by the GPU: a range of indices, and one number for all of it.
struct Range {
  std::uint32_t count, instances, first_index, base_vertex, base_instance, number;
};

void fill(gl::MappedBuffer& buffer, const void* data, std::size_t bytes) {
  buffer.reserve(bytes);
  std::memcpy(buffer.data(), data, bytes);
}

}  // namespace

// A triangle over the lower left half of a 4 x 4 image covers the pixels whose centre has x + y < 4 (x, y in
// pixels from the corner): rows of 3 (centre 3.5 + 0.5 = 4 lies on the edge), 2, 1 and 0 pixels inside; those
// on the edge may go either way. One of its corners is half-way between two points. Behind it, in a separate
// range, a square of two triangles fills the image; a window leaves out the last column.
TEST(GlDrawRanges, NumbersFacesOfEachRangeFromItsOwn) {
  gl::Context::shared();
  gl::Framebuffer target(4, 4, {gl::Format::kR32ui}, gl::DepthBuffer::kDepth);
  gl::Program program("contact/skin.vert", "contact/skin.frag");
  const std::vector<float> points = {9,  9,  9,    0,                   // another surface's point
                                     -1, -1, 0.5f, 0, 3,  -1, 0.5f, 0,  // the triangle
                                     -1, 1,  0.5f, 0, -1, -1, 0.9f, 0,  // the square
                                     1,  -1, 0.9f, 0, 1,  1,  0.9f, 0, -1, 1, 0.9f, 0};
  gl::MappedBuffer points_sent(gl::MappedBuffer::For::kUpload), ranges_sent(gl::MappedBuffer::For::kUpload);
  fill(points_sent, points.data(), points.size() * sizeof(float));
  struct Vertex {
    std::array<std::uint32_t, 4> carriers;
    std::array<float, 4> weights;
  };
  const std::vector<Vertex> vertices = {
      {{0, 0, 0, 0}, {1, 0, 0, 0}}, {{0, 1, 0, 0}, {0.5f, 0.5f, 0, 0}}, {{2, 2, 2, 2}, {0, 0, 0.25f, 0.75f}},
      {{3, 3, 3, 3}, {1, 0, 0, 0}}, {{4, 4, 4, 4}, {1, 0, 0, 0}},       {{5, 5, 5, 5}, {1, 0, 0, 0}},
      {{6, 6, 6, 6}, {1, 0, 0, 0}}};
  gl::Buffer vertex_buffer, corner_buffer;
  vertex_buffer.upload(vertices);
  corner_buffer.upload(std::vector<std::uint32_t>{3, 4, 5, 3, 5, 6, 0, 1, 2});
  gl::VertexArray layout;
  layout.attribute_unsigned(0, vertex_buffer, 4, sizeof(Vertex));
  layout.attribute(1, vertex_buffer, 4, sizeof(Vertex), offsetof(Vertex, weights));
  layout.indices(corner_buffer);
  const std::vector<Range> ranges = {{0, 0, 0, 0, 0, 0}, {3, 1, 6, 0, 1, 100}, {6, 1, 0, 0, 2, 40}};
  fill(ranges_sent, ranges.data(), ranges.size() * sizeof(Range));
  layout.attribute_per_draw(2, ranges_sent, sizeof(Range), offsetof(Range, number));
  const std::array<Eigen::Vector4f, 3> camera = {Eigen::Vector4f::UnitX(), Eigen::Vector4f::UnitY(),
                                                 Eigen::Vector4f::UnitZ()};
  program.set("camera", camera);
  program.set("first_point", 1u);
  target.bind();
  gl::set_plain_state(4, 4, gl::Keep::kLeastDepth);
  target.clear(0, 0u);
  target.clear_depth(1.0f);
  gl::set_window(0, 0, 3, 4);
  glViewport(0, 0, 4, 4);  // the scissor is smaller
  program.use();
  points_sent.bind_storage(0);
  gl::draw_ranges(layout, ranges_sent, sizeof(Range), 2, sizeof(Range));
  gl::finish("the test");
  const auto faces = target.read_r32ui();
  const auto depth = target.read_depth();
  int first = 0, second = 0;
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) {
      const auto at = static_cast<std::size_t>(4 * y + x);
      if (x == 3) {
        EXPECT_EQ(faces[at], 0u) << y;
      } else if (x + y < 3) {
        EXPECT_EQ(faces[at], 101u) << x << " " << y;
        EXPECT_NEAR(depth[at], 0.75, 1e-6);
      } else if (x + y > 3) {
        EXPECT_TRUE(faces[at] == 41u || faces[at] == 42u) << x << " " << y;
        EXPECT_NEAR(depth[at], 0.95, 1e-6);
        (faces[at] == 41u ? first : second) += 1;
      }
    }
  EXPECT_EQ(first + second, 3);
  EXPECT_GE(second, 1);  // the upper left half
}

TEST(GlMappedBuffer, ShowsWhatTheGpuWroteAndGrows) {
  gl::Context::shared();
  gl::Buffer from;
  from.upload(std::vector<std::uint32_t>{7, 8, 9});
  gl::MappedBuffer to(gl::MappedBuffer::For::kReadback);
  to.reserve(8);
  gl::copy(from, to, 8);
  gl::finish("the test");
  std::array<std::uint32_t, 2> read{};
  std::memcpy(read.data(), to.data(), 8);
  EXPECT_EQ(read[1], 8u);
  to.reserve(1000);
  EXPECT_GE(to.capacity(), 1000u);
  gl::copy(from, to, 12);
  gl::finish("the test");
  std::memcpy(read.data(), to.data() + 4, 8);
  EXPECT_EQ(read[1], 9u);
  EXPECT_THROW(to.bind_storage(0, 4, 8), InternalError);  // not aligned
  EXPECT_THROW(to.bind_storage(0, 0, to.capacity() + 1), InternalError);
}
