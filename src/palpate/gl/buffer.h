#pragma once
#include <cstddef>
#include <vector>

namespace palpate::gl {

class MappedBuffer;

/// Bytes on the GPU: vertices, indices, shader storage.  Storage grows to the largest upload and is kept.
class Buffer {
 public:
  Buffer();
  ~Buffer();
  Buffer(Buffer&& other) noexcept;
  Buffer& operator=(Buffer&& other) noexcept;

  /// Replaces the contents (the old ones are orphaned, so that the GPU need not be waited for).
  void upload(const void* data, std::size_t bytes);
  template <class T>
  void upload(const std::vector<T>& values) {
    upload(values.data(), values.size() * sizeof(T));
  }
  /// Makes room for at least that many bytes; contents undefined when it had to grow.
  void reserve(std::size_t bytes);
  /// Copies bytes [offset, offset + bytes) back, waiting for the GPU.
  void read(void* out, std::size_t bytes, std::size_t offset = 0) const;
  /// Overwrites bytes [offset, offset + bytes).
  void write(const void* data, std::size_t bytes, std::size_t offset = 0);

  unsigned id() const { return id_; }
  std::size_t capacity() const { return capacity_; }
  void bind_storage(unsigned index) const;  ///< shader storage block `index`

 private:
  unsigned id_ = 0;
  std::size_t capacity_ = 0;
};

/// Which buffers feed the vertex attributes.
class VertexArray {
 public:
  VertexArray();
  ~VertexArray();
  VertexArray(VertexArray&& other) noexcept;
  VertexArray& operator=(VertexArray&& other) noexcept;

  /// Attribute `location` reads `components` floats a vertex, `stride` bytes apart, from `offset`.
  void attribute(unsigned location, const Buffer& buffer, int components, int stride, std::size_t offset = 0);
  /// Likewise of unsigned 32-bit numbers.
  void attribute_unsigned(unsigned location, const Buffer& buffer, int components, int stride,
                          std::size_t offset = 0);
  /// One such number a draw in place of a vertex: record number `base_instance` of the draw.
  void attribute_a_draw(unsigned location, const MappedBuffer& buffer, int stride, std::size_t offset);
  void indices(const Buffer& buffer);  ///< of unsigned 32-bit
  void bind() const;
  unsigned id() const { return id_; }

 private:
  unsigned id_ = 0;
};

}  // namespace palpate::gl
