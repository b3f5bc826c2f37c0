#pragma once
#include <string>
#include <string_view>

namespace palpate {

/// Text for a terminal.  Control characters, which names in files may have, would move its cursor, clear it
/// or change its colours: each is replaced by its escape (\x1b), but for the end of a line and the tabulator.
/// C1 controls in UTF-8 (U+0080 to U+009F) are control characters too.
std::string printable(std::string_view text);

/// Whether printable() would change it.
bool is_printable(std::string_view text);

}  // namespace palpate
