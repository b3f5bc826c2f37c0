#include "core/printable.h"

#include <fmt/format.h>

#include <iterator>

namespace palpate {
namespace {

/// Returns the length in bytes of the control character at `at`; 0 for none.
std::size_t control_at(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
  constexpr unsigned kDelete = 0x7f, kLeadOfC1 = 0xc2, kFirstC1 = 0x80, kLastC1 = 0x9f;
  if (byte(at) == kLeadOfC1 && byte(at + 1) >= kFirstC1 && byte(at + 1) <= kLastC1) return 2;
  return (byte(at) < ' ' && text[at] != '\n' && text[at] != '\t') || byte(at) == kDelete ? 1 : 0;
}

}  // namespace

std::string printable(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t bytes = control_at(text, i);
    for (std::size_t k = 0; k < bytes; ++k)
      fmt::format_to(std::back_inserter(out), "\\x{:02x}", static_cast<unsigned char>(text[i + k]));
    if (bytes == 0) out += text[i];
    i += bytes == 0 ? 1 : bytes;
  }
  return out;
}

bool is_printable(std::string_view text) {
  for (std::size_t i = 0; i < text.size(); ++i)
    if (control_at(text, i) > 0) return false;
  return true;
}

}  // namespace palpate
