#include <cstdio>
#include <fstream>
#include <iterator>

#include "palpate/core/error.h"
#include "palpate/report/table.h"

namespace palpate::report {
namespace {

/// One pass over the text; a record ends at a line break outside quotes.
class CsvReader {
 public:
  CsvReader(std::string text, std::string source) : text_(std::move(text)), source_(std::move(source)) {}

  bool next(std::vector<std::string>& cells) {
    while (at_ < text_.size() && (text_[at_] == '#' || text_[at_] == '\n' || text_[at_] == '\r')) skip_line();
    if (at_ >= text_.size()) return false;
    record_line_ = line_;
    cells.assign(1, "");
    for (; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (c == '"') {
        read_quoted(cells.back());
      } else if (c == ',') {
        cells.emplace_back();
      } else if (c == '\n') {
        ++at_;
        ++line_;
        return true;
      } else if (c != '\r') {
        cells.back() += c;
      }
    }
    return true;
  }

  int record_line() const { return record_line_; }

 private:
  void skip_line() {
    while (at_ < text_.size() && text_[at_] != '\n') ++at_;
    ++at_;
    ++line_;
  }

  /// Stands on the opening quote; leaves on the closing one.
  void read_quoted(std::string& cell) {
    for (++at_; at_ < text_.size(); ++at_) {
      if (text_[at_] == '"') {
        if (at_ + 1 < text_.size() && text_[at_ + 1] == '"') ++at_;
        else return;
      }
      if (text_[at_] == '\n') ++line_;
      cell += text_[at_];
    }
    fail("{}:{}: a quoted cell is never closed; add the missing \"", source_, record_line_);
  }

  std::string text_, source_;
  std::size_t at_ = 0;
  int line_ = 1, record_line_ = 1;
};

}  // namespace

Table read_csv(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) fail("{}: cannot be opened for reading; check the path and its permissions", path.string());
  CsvReader reader({std::istreambuf_iterator<char>(in), {}}, path.string());
  Table table;
  table.source = path.string();
  if (!reader.next(table.headers)) fail("{}: is empty; a line of column names was expected", path.string());
  std::vector<std::string> cells;
  while (reader.next(cells)) {
    if (cells.size() != table.headers.size())
      fail("{}:{}: {} cells under {} columns; the file was cut short or a comma is missing", path.string(), reader.record_line(), cells.size(),
           table.headers.size());
    table.rows.push_back(cells);
  }
  return table;
}

}  // namespace palpate::report
