#pragma once
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/types.h"

/// Serialization of plain data to bytes, bitwise: archives of results (archive_bytes.h), and the frames of a
/// picture on disk.
namespace palpate {

/// Appends values to a byte string; texts and vectors are preceded by their length.
class ByteWriter {
 public:
  /// Appends a number or an enumeration.
  template <class T>
  ByteWriter& put(const T& value) {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  /// Appends the length and the characters.
  ByteWriter& put(const std::string& text) {
    put(text.size());
    bytes_ += text;
    return *this;
  }
  /// Appends the length and the values.
  ByteWriter& put(const VecX& values) {
    return put_range(values.data(), static_cast<std::size_t>(values.size()));
  }
  ByteWriter& put(const std::vector<double>& values) { return put_range(values.data(), values.size()); }
  /// Returns all bytes; the writer is empty afterwards.
  std::string take() { return std::move(bytes_); }

 private:
  ByteWriter& put_range(const double* data, std::size_t count) {
    put(count);
    bytes_.append(reinterpret_cast<const char*>(data), count * sizeof(double));
    return *this;
  }
  std::string bytes_;
};

/// Reads values in the order of writing.  @throws Error where the bytes end too soon
class ByteReader {
 public:
  /// @param bytes  must outlive the reader
  explicit ByteReader(const std::string& bytes) : bytes_(bytes) {}
  /// Reads the next value: a number, enumeration, std::string, VecX or std::vector<double>.
  template <class T>
  T get() {
    if constexpr (std::is_same_v<T, std::string>) {
      const auto count = get<std::size_t>();
      return std::string(take(count), count);
    } else if constexpr (std::is_same_v<T, VecX>) {
      const auto count = get<std::size_t>();
      const char* from = take_doubles(count);
      VecX out(static_cast<Eigen::Index>(count));
      std::memcpy(out.data(), from, count * sizeof(double));
      return out;
    } else if constexpr (std::is_same_v<T, std::vector<double>>) {
      const auto count = get<std::size_t>();
      const char* from = take_doubles(count);
      std::vector<double> out(count);
      std::memcpy(out.data(), from, count * sizeof(double));
      return out;
    } else {
      T value;
      std::memcpy(&value, take(sizeof value), sizeof value);
      return value;
    }
  }
  /// Whether all bytes have been read.
  bool at_end() const { return at_ == bytes_.size(); }

 private:
  const char* take_doubles(std::size_t count) {
    return take(count <= bytes_.size() ? count * sizeof(double) : count);
  }
  const char* take(std::size_t count) {
    if (count > bytes_.size() - at_)
      fail("a stored result is truncated ({} of {} bytes)", at_, bytes_.size());
    const char* out = bytes_.data() + at_;
    at_ += count;
    return out;
  }
  const std::string& bytes_;
  std::size_t at_ = 0;
};

}  // namespace palpate
