#include "gl/commands.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include "gl/buffer.h"
#include "gl/context.h"
#include "gl/mapped_buffer.h"
#include "gl/program.h"

namespace palpate::gl {

void set_plain_state(int width, int height, Keep keep) {
  for (const int feature : {GL_BLEND, GL_CULL_FACE, GL_SCISSOR_TEST, GL_STENCIL_TEST, GL_POLYGON_OFFSET_FILL,
                            GL_DEPTH_CLAMP, GL_MULTISAMPLE})
    glDisable(static_cast<GLenum>(feature));
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDepthMask(GL_TRUE);
  glDepthRangef(0.0f, 1.0f);
  glViewport(0, 0, width, height);
  if (keep == Keep::kAll) {
    glDisable(GL_DEPTH_TEST);
  } else {
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(keep == Keep::kLeastDepth ? GL_LESS : GL_GREATER);
  }
}

void cull(bool leave_out_counter_clockwise) {
  glEnable(GL_CULL_FACE);
  glFrontFace(GL_CCW);
  glCullFace(leave_out_counter_clockwise ? GL_FRONT : GL_BACK);
}

void draw_triangles(const VertexArray& vertices, std::size_t index_count) {
  vertices.bind();
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(index_count), GL_UNSIGNED_INT, nullptr);
}

void set_window(int x, int y, int width, int height) {
  glEnable(GL_SCISSOR_TEST);
  glScissor(x, y, width, height);
  glViewport(x, y, width, height);
}

void draw_ranges(const VertexArray& vertices, const MappedBuffer& ranges, std::size_t offset,
                 std::size_t count, std::size_t stride) {
  vertices.bind();
  glBindBuffer(GL_DRAW_INDIRECT_BUFFER, ranges.id());
  glMultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT, reinterpret_cast<const void*>(offset),
                              static_cast<GLsizei>(count), static_cast<GLsizei>(stride));
}

void copy(const Buffer& from, MappedBuffer& to, std::size_t bytes) {
  glBindBuffer(GL_COPY_READ_BUFFER, from.id());
  glBindBuffer(GL_COPY_WRITE_BUFFER, to.id());
  glCopyBufferSubData(GL_COPY_READ_BUFFER, GL_COPY_WRITE_BUFFER, 0, 0, static_cast<GLsizeiptr>(bytes));
}

void finish(const char* what) {
  glMemoryBarrier(GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT);
  const GLsync fence = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
  constexpr GLuint64 kNanoseconds = 1'000'000'000;
  GLenum state = GL_TIMEOUT_EXPIRED;
  for (int second = 0; second < 60 && state == GL_TIMEOUT_EXPIRED; ++second)
    state = glClientWaitSync(fence, GL_SYNC_FLUSH_COMMANDS_BIT, kNanoseconds);
  glDeleteSync(fence);
  check_context(what);
  if (state == GL_TIMEOUT_EXPIRED || state == GL_WAIT_FAILED)
    throw ContextLost(fmt::format("{}: the GPU did not answer within a minute", what));
  check_errors(what);
}

int vertex_storage_blocks() {
  GLint count = 0;
  glGetIntegerv(GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS, &count);
  return count;
}

int largest_texture() {
  GLint size = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &size);
  return size;
}

void dispatch(const Program& program, int groups_x, int groups_y, int groups_z) {
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  program.use();
  glDispatchCompute(static_cast<GLuint>(groups_x), static_cast<GLuint>(groups_y),
                    static_cast<GLuint>(groups_z));
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT |
                  GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT);
}

}  // namespace palpate::gl
