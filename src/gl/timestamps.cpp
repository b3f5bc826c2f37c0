#include "gl/timestamps.h"

#include <epoxy/gl.h>

#include "gl/context.h"
#include "palpate/core/error.h"

namespace palpate::gl {

Timestamps::Timestamps(int count) {
  PALPATE_CHECK(count > 0, "{} timestamps", count);
  GLint bits = 0;
  glGetQueryiv(GL_TIMESTAMP, GL_QUERY_COUNTER_BITS, &bits);
  if (bits == 0) return;
  ids_.resize(static_cast<std::size_t>(count));
  glGenQueries(count, ids_.data());
}

Timestamps::~Timestamps() {
  for (const unsigned id : ids_) Context::destroy(ObjectKind::kQuery, id);
}

void Timestamps::mark(int which) {
  if (!ids_.empty()) glQueryCounter(ids_.at(static_cast<std::size_t>(which)), GL_TIMESTAMP);
}

double Timestamps::seconds(int from, int to) const {
  if (ids_.empty()) return 0.0;
  const auto nanoseconds = [&](int which) {
    GLuint64 at = 0;
    glGetQueryObjectui64v(ids_.at(static_cast<std::size_t>(which)), GL_QUERY_RESULT, &at);
    return at;
  };
  const GLuint64 first = nanoseconds(from), last = nanoseconds(to);
  return 1e-9 * (last > first ? static_cast<double>(last - first) : 0.0);
}

}  // namespace palpate::gl
