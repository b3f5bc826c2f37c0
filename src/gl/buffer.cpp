#include "gl/buffer.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <utility>

#include "gl/context.h"
#include "gl/mapped_buffer.h"
#include "palpate/core/error.h"

namespace palpate::gl {
namespace {
// A target without vertex array or indexed binding: binding a buffer to it changes no other state.
constexpr GLenum kScratchTarget = GL_COPY_WRITE_BUFFER;
}  // namespace

Buffer::Buffer() { glGenBuffers(1, &id_); }

Buffer::~Buffer() {
  if (id_) Context::destroy(ObjectKind::kBuffer, id_);
}

Buffer::Buffer(Buffer&& other) noexcept
    : id_(std::exchange(other.id_, 0)), capacity_(std::exchange(other.capacity_, 0)) {}

Buffer& Buffer::operator=(Buffer&& other) noexcept {
  std::swap(id_, other.id_);
  std::swap(capacity_, other.capacity_);
  return *this;
}

void Buffer::upload(const void* data, std::size_t bytes) {
  capacity_ = std::max({capacity_, bytes, std::size_t{16}});
  glBindBuffer(kScratchTarget, id_);
  glBufferData(kScratchTarget, static_cast<GLsizeiptr>(capacity_), nullptr, GL_DYNAMIC_DRAW);
  if (bytes > 0) glBufferSubData(kScratchTarget, 0, static_cast<GLsizeiptr>(bytes), data);
}

void Buffer::reserve(std::size_t bytes) {
  if (bytes <= capacity_) return;
  capacity_ = bytes;
  glBindBuffer(kScratchTarget, id_);
  glBufferData(kScratchTarget, static_cast<GLsizeiptr>(capacity_), nullptr, GL_DYNAMIC_DRAW);
}

void Buffer::read(void* out, std::size_t bytes, std::size_t offset) const {
  PALPATE_CHECK(offset + bytes <= capacity_, "reading {} bytes at {} of a buffer of {}", bytes, offset,
                capacity_);
  glBindBuffer(kScratchTarget, id_);
  glGetBufferSubData(kScratchTarget, static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(bytes), out);
}

void Buffer::write(const void* data, std::size_t bytes, std::size_t offset) {
  PALPATE_CHECK(offset + bytes <= capacity_, "writing {} bytes at {} of a buffer of {}", bytes, offset,
                capacity_);
  glBindBuffer(kScratchTarget, id_);
  glBufferSubData(kScratchTarget, static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(bytes), data);
}

void Buffer::bind_storage(unsigned index) const { glBindBufferBase(GL_SHADER_STORAGE_BUFFER, index, id_); }

VertexArray::VertexArray() { glGenVertexArrays(1, &id_); }

VertexArray::~VertexArray() {
  if (id_) Context::destroy(ObjectKind::kVertexArray, id_);
}

VertexArray::VertexArray(VertexArray&& other) noexcept : id_(std::exchange(other.id_, 0)) {}

VertexArray& VertexArray::operator=(VertexArray&& other) noexcept {
  std::swap(id_, other.id_);
  return *this;
}

void VertexArray::attribute(unsigned location, const Buffer& buffer, int components, int stride,
                            std::size_t offset) {
  glBindVertexArray(id_);
  glBindBuffer(GL_ARRAY_BUFFER, buffer.id());
  glEnableVertexAttribArray(location);
  glVertexAttribPointer(location, components, GL_FLOAT, GL_FALSE, stride,
                        reinterpret_cast<const void*>(offset));
}

void VertexArray::attribute_unsigned(unsigned location, const Buffer& buffer, int components, int stride,
                                     std::size_t offset) {
  glBindVertexArray(id_);
  glBindBuffer(GL_ARRAY_BUFFER, buffer.id());
  glEnableVertexAttribArray(location);
  glVertexAttribIPointer(location, components, GL_UNSIGNED_INT, stride,
                         reinterpret_cast<const void*>(offset));
}

void VertexArray::attribute_per_draw(unsigned location, const MappedBuffer& buffer, int stride,
                                     std::size_t offset) {
  glBindVertexArray(id_);
  glBindBuffer(GL_ARRAY_BUFFER, buffer.id());
  glEnableVertexAttribArray(location);
  glVertexAttribIPointer(location, 1, GL_UNSIGNED_INT, stride, reinterpret_cast<const void*>(offset));
  glVertexAttribDivisor(location, 1);
}

void VertexArray::indices(const Buffer& buffer) {
  glBindVertexArray(id_);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffer.id());
}

void VertexArray::bind() const { glBindVertexArray(id_); }

}  // namespace palpate::gl
