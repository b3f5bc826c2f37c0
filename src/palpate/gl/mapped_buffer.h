#pragma once
#include <cstddef>

namespace palpate::gl {

/// Bytes that the processor and the GPU share: mapped once and for good (GL 4.4 or ARB_buffer_storage), so
/// that no call copies or waits.  What the GPU reads may be written, and what it wrote may be read, after
/// finish() (commands.h).
class MappedBuffer {
 public:
  enum class For { kUpload, kReadback };
  explicit MappedBuffer(For use);  ///< @throws Error where OpenGL has no such buffers
  ~MappedBuffer();
  MappedBuffer(const MappedBuffer&) = delete;
  MappedBuffer& operator=(const MappedBuffer&) = delete;

  /// Makes room; contents undefined, and `data` and `id` others, when it had to grow.
  void reserve(std::size_t bytes);
  std::byte* data() { return data_; }
  std::size_t capacity() const { return capacity_; }
  unsigned id() const { return id_; }
  void bind_storage(unsigned index) const;  ///< shader storage block `index`
  /// Part of it; `offset` a multiple of kStorageAlignment.
  void bind_storage(unsigned index, std::size_t offset, std::size_t bytes) const;
  static constexpr std::size_t kStorageAlignment = 256;  ///< the most that GL lets a driver ask for

 private:
  void release();
  For use_;
  unsigned id_ = 0;
  std::size_t capacity_ = 0;
  std::byte* data_ = nullptr;
};

}  // namespace palpate::gl
