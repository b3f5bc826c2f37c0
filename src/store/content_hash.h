#pragma once
#include <span>
#include <string>
#include <string_view>

namespace palpate::store {

/// Hash of 128 bits (FNV-1a) that identifies content: equal content gives equal hashes on every machine. Not
/// cryptographic: it tells results apart, but does not protect against deliberate collisions.
class ContentHash {
 public:
  /// Adds a text with its length: "ab", "c" differs from "a", "bc".
  ContentHash& add(std::string_view text);
  /// Adds the file's bytes; a missing file has a distinct hash.
  ContentHash& add_file(const std::string& path);
  /// Adds a part of a stream, without its length: "ab", "c" equals "abc".
  ContentHash& add_part(std::string_view bytes);
  /// Adds numbers as words of 64 bits: eight times as fast.  Each bit counts.
  ContentHash& add_numbers(std::span<const double> numbers);
  std::string hex() const;  ///< Hash as 32 hexadecimal digits.

 private:
  void mix(std::string_view bytes);
  void mix_word(unsigned long long word);
  unsigned long long high_ = 0x6c62272e07bb0142ull, low_ = 0x62b821756295c58dull;  ///< FNV offset basis.
};

}  // namespace palpate::store
