#pragma once
#include <string>
#include <string_view>

/// Text as XML and HTML want it.
namespace palpate {

/// & < > " ' as entities; control characters that XML and HTML forbid become U+FFFD.
std::string escape_markup(std::string_view text);

/// Bytes as base64 (RFC 4648), padded.
std::string base64(std::string_view bytes);

}  // namespace palpate
