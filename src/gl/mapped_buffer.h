#pragma once
#include <cstddef>

namespace palpate::gl {

/// Buffer shared by CPU and GPU, persistently mapped (GL 4.4 or ARB_buffer_storage), so that no call copies
/// or waits.  After finish() (commands.h) the CPU may overwrite data that the GPU has read, and read data
/// that the GPU has written.
class MappedBuffer {
 public:
  enum class For { kUpload, kReadback };
  explicit MappedBuffer(For use);  ///< @throws Error where OpenGL lacks such buffers
  ~MappedBuffer();
  MappedBuffer(const MappedBuffer&) = delete;
  MappedBuffer& operator=(const MappedBuffer&) = delete;

  /// Allocates memory; when it had to grow, contents are undefined, and `data` and `id` change.
  void reserve(std::size_t bytes);
  std::byte* data() { return data_; }
  std::size_t capacity() const { return capacity_; }
  unsigned id() const { return id_; }
  void bind_storage(unsigned index) const;  ///< Binds to shader storage block `index`.
  /// Binds a part of it; `offset` must be a multiple of kStorageAlignment.
  void bind_storage(unsigned index, std::size_t offset, std::size_t bytes) const;
  /// Largest alignment that GL allows a driver to require.
  static constexpr std::size_t kStorageAlignment = 256;

 private:
  void release();
  For use_;
  unsigned id_ = 0;
  std::size_t capacity_ = 0;
  std::byte* data_ = nullptr;
};

}  // namespace palpate::gl
