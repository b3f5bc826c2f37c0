#include "core/csv.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "palpate/core/error.h"

namespace palpate {
namespace {

constexpr std::string_view kBlanks = " \t";

bool is_line_end(char c) { return c == '\n' || c == '\r'; }

/// Checks the encoding and returns the text without its byte-order mark.
std::string_view check_encoding(std::string_view text, const std::string& path) {
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
    fail("{}:1: the file is in UTF-16; save it as CSV in UTF-8", path);
  if (text.find('\0') != std::string_view::npos)
    fail("{}: contains null bytes, so it is not CSV text; check the path", path);
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  return text;
}

/// Returns the first line that is not empty.
std::string_view first_line(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of("\r\n"), text.size()));
  return text.substr(0, text.find_first_of("\r\n"));
}

char delimiter_of(std::string_view line) {
  constexpr std::string_view kDelimiters = ",;\t";
  std::size_t counts[kDelimiters.size()] = {};
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') quoted = !quoted;
    const std::size_t which = kDelimiters.find(c);
    if (!quoted && which != std::string_view::npos) ++counts[which];
  }
  return kDelimiters[static_cast<std::size_t>(std::max_element(counts, counts + kDelimiters.size()) -
                                              counts)];
}

/// Splits a text into rows, character by character.
class Splitter {
 public:
  Splitter(char delimiter, const std::string& path) : delimiter_(delimiter), path_(path) {}

  std::vector<CsvRow> split(std::string_view text) {
    for (std::size_t i = 0; i < text.size(); ++i) {
      const char c = text[i], next = i + 1 < text.size() ? text[i + 1] : '\0';
      if (quoted_)
        i += in_quotes(c, next);
      else if (c == delimiter_)
        end_cell(), any_ = true;
      else if (c == '\r' && next == '\n')
        continue;
      else if (is_line_end(c))
        end_row();
      else if (c == '"' && cell_.find_first_not_of(kBlanks) == std::string::npos)
        cell_.clear(), quoted_ = was_quoted_ = any_ = true, opened_ = line_;
      else if (!was_quoted_ || kBlanks.find(c) == std::string_view::npos)
        cell_ += c;
      line_ += c == '\n' || (c == '\r' && next != '\n');
    }
    if (quoted_) fail("{}:{}: unterminated quote", path_, opened_);
    end_row();
    return std::move(rows_);
  }

 private:
  /// Handles a character inside quotes.  @return number of characters consumed in addition to c
  std::size_t in_quotes(char c, char next) {
    if (c != '"' || next == '"') {
      cell_ += c;
      return c == '"' ? 1 : 0;
    }
    quoted_ = false;
    return 0;
  }

  void end_cell() {
    if (!was_quoted_) {
      const std::size_t first = std::min(cell_.find_first_not_of(kBlanks), cell_.size());
      cell_ = cell_.substr(first, cell_.find_last_not_of(kBlanks) + 1 - first);
    }
    any_ = any_ || !cell_.empty();
    row_.cells.push_back(std::exchange(cell_, {}));
    was_quoted_ = false;
  }

  void end_row() {
    end_cell();
    if (any_) rows_.push_back(std::move(row_));
    row_ = {line_ + 1, {}};
    any_ = false;
  }

  char delimiter_;
  const std::string& path_;
  std::vector<CsvRow> rows_;
  CsvRow row_{1, {}};
  std::string cell_;
  bool quoted_ = false;      ///< Inside quotes.
  bool was_quoted_ = false;  ///< This cell began with a quote.
  bool any_ = false;         ///< This line is not empty.
  long line_ = 1, opened_ = 0;
};

}  // namespace

std::vector<CsvRow> read_csv_text(std::string_view text, const std::string& path) {
  text = check_encoding(text, path);
  const std::string_view line = first_line(text);
  const bool says = line.size() == 5 && line.starts_with("sep=");  // Delimiter line written by spreadsheets.
  std::vector<CsvRow> rows = Splitter(says ? line[4] : delimiter_of(line), path).split(text);
  if (says) rows.erase(rows.begin());
  return rows;
}

bool read_csv_number(std::string_view cell, double& out) {
  std::string text(cell);
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.erase(0, 1);
  if (text.find('.') == std::string::npos && std::count(text.begin(), text.end(), ',') == 1)
    text[text.find(',')] = '.';
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return false;
  out = value;
  return true;
}

}  // namespace palpate
