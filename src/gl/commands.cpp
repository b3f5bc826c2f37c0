#include "palpate/gl/commands.h"

#include <epoxy/gl.h>

#include "palpate/gl/buffer.h"
#include "palpate/gl/program.h"

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

void cull_and_count(bool leave_out_counter_clockwise) {
  glEnable(GL_CULL_FACE);
  glFrontFace(GL_CCW);
  glCullFace(leave_out_counter_clockwise ? GL_FRONT : GL_BACK);
  glEnable(GL_STENCIL_TEST);
  glStencilMask(0xffu);
  glStencilFunc(GL_ALWAYS, 0, 0xffu);
  glStencilOp(GL_INCR, GL_INCR, GL_INCR);
}

void draw_triangles(const VertexArray& vertices, std::size_t index_count) {
  vertices.bind();
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(index_count), GL_UNSIGNED_INT, nullptr);
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
