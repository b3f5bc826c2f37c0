#include "store/content_hash.h"

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <fstream>
#include <iterator>

namespace palpate::store {

// FNV-1a of 128 bits (Fowler, Noll, Vo; RFC draft-eastlake-fnv):
//   h = (h xor byte) * p mod 2^128,   p = 2^88 + 2^8 + 0x3b.
// With h = H 2^64 + L, where H 2^88 2^64 is 0 modulo 2^128:
//   h p = h 0x13b + (L 2^24 mod 2^64) 2^64.
// A step is invertible in h for every word: two streams that differ in one word have different hashes.
void ContentHash::mix_word(unsigned long long word) {
  low_ ^= word;
  constexpr unsigned long long kSmall = 0x13b, kMask = 0xffffffffull;
  const unsigned long long bottom = (low_ & kMask) * kSmall, top = (low_ >> 32) * kSmall + (bottom >> 32);
  high_ = high_ * kSmall + (top >> 32) + (low_ << 24);
  low_ = (top << 32) | (bottom & kMask);
}

void ContentHash::mix(std::string_view bytes) {
  for (const char c : bytes) mix_word(static_cast<unsigned char>(c));
}

ContentHash& ContentHash::add_part(std::string_view bytes) {
  mix(bytes);
  return *this;
}

ContentHash& ContentHash::add_numbers(std::span<const double> numbers) {
  for (const double number : numbers) mix_word(std::bit_cast<std::uint64_t>(number));
  return *this;
}

ContentHash& ContentHash::add(std::string_view text) {
  mix(fmt::format("{}:", text.size()));
  mix(text);
  return *this;
}

ContentHash& ContentHash::add_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return add("no file");
  return add(std::string{std::istreambuf_iterator<char>(in), {}});
}

std::string ContentHash::hex() const { return fmt::format("{:016x}{:016x}", high_, low_); }

}  // namespace palpate::store
