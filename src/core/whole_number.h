#pragma once
#include <algorithm>
#include <cstdint>
#include <string_view>

/// Whole numbers that palpate reads as doubles.  Up to 2^53 each has an exact double; beyond, two may share
/// one, and a reader that rounds would return another number than the file's.  Every reader rejects those.
namespace palpate {

inline constexpr std::int64_t kLargestWhole = std::int64_t{1} << 53;
inline constexpr const char* kWholeDemand =
    "must be at most 9007199254740992 (2^53) in magnitude; write larger numbers with an exponent, as in 1e16";

/// Whether an integer exceeds 2^53 in magnitude.
constexpr bool beyond_whole(std::int64_t value) { return value > kLargestWhole || value < -kLargestWhole; }
constexpr bool beyond_whole(std::uint64_t value) { return value > std::uint64_t{kLargestWhole}; }

/// Whether the text is an integer beyond 2^53 in magnitude; a number with a point or an exponent is none.
inline bool beyond_whole(std::string_view text) {
  if (!text.empty() && (text.front() == '-' || text.front() == '+')) text.remove_prefix(1);
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  if (text.empty() || !std::all_of(text.begin(), text.end(), is_digit)) return false;
  text.remove_prefix(std::min(text.find_first_not_of('0'), text.size()));
  constexpr std::string_view kLargest = "9007199254740992";
  return text.size() != kLargest.size() ? text.size() > kLargest.size() : text > kLargest;
}

}  // namespace palpate
