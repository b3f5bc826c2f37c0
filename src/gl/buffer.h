#pragma once
#include <cstddef>
#include <vector>

namespace palpate::gl {

class MappedBuffer;

/// Buffer on the GPU: vertices, indices, shader storage.  Storage grows to the largest upload and is kept.
class Buffer {
 public:
  Buffer();
  ~Buffer();
  Buffer(Buffer&& other) noexcept;
  Buffer& operator=(Buffer&& other) noexcept;

  /// Replaces the contents; the old storage is orphaned, so that the call does not wait for the GPU.
  void upload(const void* data, std::size_t bytes);
  template <class T>
  void upload(const std::vector<T>& values) {
    upload(values.data(), values.size() * sizeof(T));
  }
  /// Allocates at least that many bytes; contents are undefined when it had to grow.
  void reserve(std::size_t bytes);
  /// Copies bytes [offset, offset + bytes) back; waits for the GPU.
  void read(void* out, std::size_t bytes, std::size_t offset = 0) const;
  /// Overwrites bytes [offset, offset + bytes).
  void write(const void* data, std::size_t bytes, std::size_t offset = 0);

  unsigned id() const { return id_; }
  std::size_t capacity() const { return capacity_; }
  void bind_storage(unsigned index) const;  ///< Binds to shader storage block `index`.

 private:
  unsigned id_ = 0;
  std::size_t capacity_ = 0;
};

/// Vertex array object: assigns buffers to vertex attributes.
class VertexArray {
 public:
  VertexArray();
  ~VertexArray();
  VertexArray(VertexArray&& other) noexcept;
  VertexArray& operator=(VertexArray&& other) noexcept;

  /// Sets attribute `location` to read `components` floats per vertex, `stride` bytes apart, from `offset`.
  void attribute(unsigned location, const Buffer& buffer, int components, int stride, std::size_t offset = 0);
  /// As attribute(), with unsigned 32-bit integers.
  void attribute_unsigned(unsigned location, const Buffer& buffer, int components, int stride,
                          std::size_t offset = 0);
  /// Sets an unsigned 32-bit attribute that advances per draw instead of per vertex: record
  /// `base_instance` of the draw.
  void attribute_per_draw(unsigned location, const MappedBuffer& buffer, int stride, std::size_t offset);
  void indices(const Buffer& buffer);  ///< Sets the index buffer, unsigned 32-bit.
  void bind() const;
  unsigned id() const { return id_; }

 private:
  unsigned id_ = 0;
};

}  // namespace palpate::gl
