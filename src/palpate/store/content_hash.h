#pragma once
#include <span>
#include <string>
#include <string_view>

namespace palpate::store {

/// Names content by 128 bits (FNV-1a): equal content, equal name, on every machine.  It keeps results apart;
/// it keeps no enemy out.
class ContentHash {
 public:
  ContentHash& add(std::string_view text);         ///< its length counts too: "ab" + "c" is not "a" + "bc"
  ContentHash& add_file(const std::string& path);  ///< its bytes; a file that is not there counts as that
  /// A part of a stream: "ab" and "c" are as "abc".
  ContentHash& add_part(std::string_view bytes);
  /// Numbers, a word of 64 bits each: eight times as fast.  Each bit counts.
  ContentHash& add_numbers(std::span<const double> numbers);
  std::string hex() const;  ///< 32 digits

 private:
  void mix(std::string_view bytes);
  void mix_word(unsigned long long word);
  unsigned long long high_ = 0x6c62272e07bb0142ull, low_ = 0x62b821756295c58dull;  ///< FNV's offset basis
};

}  // namespace palpate::store
