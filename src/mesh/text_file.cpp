#include "text_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>

namespace palpate::mesh {
namespace {

constexpr std::string_view kBlank = " \t\r\v\f";

std::string read_whole(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored))
    palpate::fail("{}: no such file; check the path (relative to the scene file)", path);
  std::ifstream stream(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) palpate::fail("{}: cannot be read; check its permissions", path);
  return text;
}

}  // namespace

std::string printable(std::string_view word) {
  std::string out(word.substr(0, 40));
  for (char& c : out)
    if (c < ' ' || c > '~') c = '?';
  return word.size() > 40 ? out + "..." : out;
}

TextFile::TextFile(const std::string& path, TextForm form)
    : path_(path), text_(read_whole(path)), form_(form) {
  if (text_.starts_with("\xEF\xBB\xBF")) next_ = 3;  // byte order mark
  // Lines that end with a carriage return only, as in files of old Macintosh programs.
  if (text_.find('\n') == std::string::npos) std::replace(text_.begin(), text_.end(), '\r', '\n');
}

/// Returns the end of the line that begins at `from`, including its continuations, whose breaks become
/// blanks.
std::size_t TextFile::end_of_line(std::size_t from, int& lines) {
  for (std::size_t begin = from;; ++lines) {
    const std::size_t end = std::min(text_.find('\n', begin), text_.size());
    const std::string_view line = std::string_view(text_).substr(from, end - from);
    const std::size_t last = line.find_last_not_of(kBlank);
    if (!form_.continued || end == text_.size() || last == std::string_view::npos || line[last] != '\\' ||
        (form_.comment != '\0' && line.find(form_.comment) != std::string_view::npos))
      return end;
    text_[from + last] = text_[end] = ' ';
    begin = end + 1;
  }
}

bool TextFile::next_line() {
  noun_ = {};
  while (next_ < text_.size()) {
    line_number_ = ++lines_;
    const std::size_t end = end_of_line(next_, lines_);
    rest_ = std::string_view(text_).substr(next_, end - next_);
    next_ = end + 1;
    if (form_.comment != '\0') rest_ = rest_.substr(0, rest_.find(form_.comment));
    if (!at_end_of_line()) return true;
  }
  rest_ = {};
  return false;
}

void TextFile::require_line(std::string_view what) {
  if (!next_line())
    fail("the file ends where {} should follow; it is truncated, or a count in it is too large", what);
}

bool TextFile::at_end_of_line() { return rest_.find_first_not_of(kBlank) == std::string_view::npos; }

std::string_view TextFile::word() {
  const std::size_t start = std::min(rest_.find_first_not_of(kBlank), rest_.size());
  const std::size_t end = std::min(rest_.find_first_of(kBlank, start), rest_.size());
  const std::string_view out = rest_.substr(start, end - start);
  rest_.remove_prefix(end);
  return out;
}

std::string_view TextFile::rest() {
  std::string_view out = rest_;
  rest_ = {};
  out.remove_prefix(std::min(out.find_first_not_of(kBlank), out.size()));
  return out.substr(0, out.find_last_not_of(kBlank) + 1);
}

std::string_view TextFile::required_word(std::string_view what) {
  const std::string_view w = word();
  if (w.empty()) fail("{} is missing; the line has too few entries", what);
  return w;
}

double TextFile::real(std::string_view what) {
  const std::string_view w = required_word(what);
  const std::string_view digits = w.substr(w.starts_with('+') ? 1 : 0);
  double value = 0;
  const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (code == std::errc::invalid_argument || end != digits.data() + digits.size())
    fail("{} = \"{}\" is not a number", what, printable(w));
  // Out of range: 0 or infinity.
  if (code == std::errc::result_out_of_range) value = std::strtod(std::string(digits).c_str(), nullptr);
  if (!std::isfinite(value)) fail("{} = {} is not finite; write the mesh again", what, printable(w));
  return value;
}

long TextFile::integer(std::string_view what) {
  const std::string_view w = required_word(what);
  const std::string_view digits = w.substr(w.starts_with('+') ? 1 : 0);
  long value = 0;
  const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (code != std::errc() || end != digits.data() + digits.size())
    fail("{} = \"{}\" is not a whole number", what, printable(w));
  return value;
}

int TextFile::count(std::string_view what) {
  const long value = integer(what);
  if (value < 0) fail("{} = {} is negative", what, value);
  const std::size_t left = text_.size() - std::min(next_, text_.size());
  if (static_cast<std::size_t>(value) > (left + 1) / 2 || value > std::numeric_limits<int>::max())
    fail("{} = {}, but only {} bytes follow; the file is truncated, or the count is wrong", what, value,
         left);
  return static_cast<int>(value);
}

void TextFile::require_end_of_line() {
  if (!at_end_of_line())
    fail("\"{}\" is one entry too many; the kind of this line, or a count above it, is wrong",
         printable(word()));
}

}  // namespace palpate::mesh
