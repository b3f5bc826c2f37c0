#include "gl/mapped_buffer.h"

#include <epoxy/gl.h>

#include <algorithm>

#include "gl/context.h"
#include "palpate/core/error.h"

namespace palpate::gl {

MappedBuffer::MappedBuffer(For use) : use_(use) {
  if (epoxy_gl_version() < 44 && !epoxy_has_gl_extension("GL_ARB_buffer_storage"))
    fail(
        "contact on the GPU needs persistently mapped buffers (OpenGL 4.4), which {} lacks; update its "
        "driver",
        Context::shared().info().renderer);
}

MappedBuffer::~MappedBuffer() { release(); }

void MappedBuffer::release() {
  if (id_) Context::destroy(ObjectKind::kBuffer, id_);  // Also unmaps it.
  id_ = 0;
  data_ = nullptr;
}

void MappedBuffer::reserve(std::size_t bytes) {
  if (bytes <= capacity_) return;
  release();
  capacity_ = std::max(bytes, 2 * capacity_);
  const bool upload = use_ == For::kUpload;
  const GLbitfield map =
      (upload ? GL_MAP_WRITE_BIT : GL_MAP_READ_BIT) | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
  const auto size = static_cast<GLsizeiptr>(capacity_);
  glGenBuffers(1, &id_);
  glBindBuffer(GL_COPY_WRITE_BUFFER, id_);
  glBufferStorage(GL_COPY_WRITE_BUFFER, size, nullptr, map | GL_CLIENT_STORAGE_BIT);
  data_ = static_cast<std::byte*>(glMapBufferRange(GL_COPY_WRITE_BUFFER, 0, size, map));
  check_errors("mapping a buffer");
  PALPATE_CHECK(data_, "a buffer of {} bytes could not be mapped", capacity_);
}

void MappedBuffer::bind_storage(unsigned index) const {
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, index, id_);
}

void MappedBuffer::bind_storage(unsigned index, std::size_t offset, std::size_t bytes) const {
  PALPATE_CHECK(offset % kStorageAlignment == 0 && offset + bytes <= capacity_,
                "{} bytes at {} of a buffer of {}", bytes, offset, capacity_);
  glBindBufferRange(GL_SHADER_STORAGE_BUFFER, index, id_, static_cast<GLintptr>(offset),
                    static_cast<GLsizeiptr>(bytes));
}

}  // namespace palpate::gl
