#pragma once
#include <string>
#include <string_view>

/// Text in the encodings that XML and HTML require.
namespace palpate {

/// Replaces & < > " ' by entities, and control characters that XML and HTML forbid by U+FFFD.
std::string escape_markup(std::string_view text);

/// Returns bytes as base64 (RFC 4648), padded.
std::string base64(std::string_view bytes);

}  // namespace palpate
