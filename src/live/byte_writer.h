#pragma once
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

namespace palpate::live {

static_assert(std::endian::native == std::endian::little, "binary messages are little endian");

/// Bytes of a message.
using Bytes = std::vector<std::uint8_t>;

/// Appends numbers to a binary message, which begins with its kind and its length.
class ByteWriter {
 public:
  /// Starts a message.  @param out  is replaced; its memory is reused
  ByteWriter(Bytes& out, std::uint32_t kind) : out_(out) {
    out_.clear();
    add(kind);
    add(std::uint32_t{0});
  }
  template <class Number>
  requires(std::is_arithmetic_v<Number>) void add(Number value) {
    const std::size_t at = out_.size();
    out_.resize(at + sizeof value);
    std::memcpy(out_.data() + at, &value, sizeof value);
  }
  template <class Number>
  void add(std::span<const Number> values) {
    const std::size_t at = out_.size();
    out_.resize(at + values.size_bytes());
    if (!values.empty()) std::memcpy(out_.data() + at, values.data(), values.size_bytes());
  }
  /// Writes the length of the message into its head.
  void close() {
    const auto length = static_cast<std::uint32_t>(out_.size());
    std::memcpy(out_.data() + 4, &length, sizeof length);
  }

 private:
  Bytes& out_;
};

}  // namespace palpate::live
