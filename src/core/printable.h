#pragma once
#include <string>
#include <string_view>

namespace palpate {

/// Makes text safe for a terminal.  Control characters, which file names may contain, would move its cursor,
/// clear it or change its colours: each except newline and tab is replaced by its escape (\x1b).  C1 controls
/// in UTF-8 (U+0080 to U+009F) count as control characters.
std::string printable(std::string_view text);

/// Whether printable() leaves the text unchanged.
bool is_printable(std::string_view text);

}  // namespace palpate
