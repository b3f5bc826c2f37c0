#include "palpate/store/csv.h"

#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/store/atomic_file.h"

namespace palpate::store {
namespace {

/// RFC 4180: quotes around a cell that holds a comma, a quote or a line end; quotes inside doubled.
void append_text(std::string& line, const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) {
    line += text;
    return;
  }
  line += '"';
  for (const char c : text) line.append(c == '"' ? 2 : 1, c);
  line += '"';
}

void append_number(std::string& line, double value) { fmt::format_to(std::back_inserter(line), "{}", value); }

/// Splits a whole file into cells; the line number of a quote that never closes goes into the message.
std::vector<std::vector<std::string>> split(const std::string& text, const std::string& path) {
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> row(1);
  bool quoted = false, any = false;
  int line = 1, opened = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '\n') ++line;
    if (quoted) {
      if (c != '"')
        row.back() += c;
      else if (i + 1 < text.size() && text[i + 1] == '"')
        row.back() += text[i++];
      else
        quoted = false;
    } else if (c == '"') {
      quoted = any = true;
      opened = line;
    } else if (c == ',') {
      row.emplace_back();
      any = true;
    } else if (c == '\n') {
      if (any) rows.push_back(std::exchange(row, std::vector<std::string>(1)));
      any = false;
    } else if (c != '\r') {
      row.back() += c;
      any = true;
    }
  }
  if (quoted) fail("{}:{}: a quote is never closed", path, opened);
  if (any) rows.push_back(row);
  return rows;
}

}  // namespace

CsvWriter::CsvWriter(const std::string& path, std::vector<std::string> headers)
    : path_(path), columns_(headers.size()) {
  out_.rdbuf()->pubsetbuf(nullptr, 0);  // whole lines at once, gathered here
  errno = 0;
  out_.open(path, std::ios::binary | std::ios::trunc);
  if (!out_) fail("{}: cannot be written ({}); is its folder there, writable, and not full?", path, reason());
  for (const std::string& header : headers) {
    append_text(line_, header);
    line_ += ',';
  }
  end_row(headers.size());
  rows_ = 0;
}

CsvWriter::CsvWriter(const std::string& path, std::vector<std::string> headers, const Place& place)
    : path_(path), columns_(headers.size()), rows_(place.rows) {
  cut_to(path, place.bytes);
  out_.rdbuf()->pubsetbuf(nullptr, 0);
  errno = 0;
  out_.open(path, std::ios::binary | std::ios::app);
  if (!out_) fail("{}: cannot be written ({}); is its folder there, writable, and not full?", path, reason());
}

CsvWriter::Place CsvWriter::place() {
  hand_over();
  return {static_cast<std::int64_t>(std::filesystem::file_size(path_)), rows_};
}

void CsvWriter::Place::archive(Archive& a) {
  a("bytes", bytes);
  a("rows", rows);
}

void CsvWriter::row(std::span<const double> values) {
  for (const double value : values) {
    append_number(line_, value);
    line_ += ',';
  }
  end_row(values.size());
}

void CsvWriter::row(const std::vector<CsvCell>& cells) {
  for (const CsvCell& cell : cells) {
    if (const double* value = std::get_if<double>(&cell))
      append_number(line_, *value);
    else
      append_text(line_, std::get<std::string>(cell));
    line_ += ',';
  }
  end_row(cells.size());
}

void CsvWriter::end_row(std::size_t cells) {
  PALPATE_CHECK(cells == columns_ && cells > 0, "{}: {} cells, {} headers", path_, cells, columns_);
  line_.back() = '\n';
  lines_ += line_;
  line_.clear();
  ++rows_;
  constexpr std::size_t kEnough = 64u << 10;
  if (lines_.size() > kEnough) hand_over();
}

void CsvWriter::hand_over() {
  errno = 0;
  out_.write(lines_.data(), static_cast<std::streamsize>(lines_.size()));
  out_.flush();
  lines_.clear();
  if (!out_) fail("{}: cannot be written any further ({}); is the disk full?", path_, reason());
}

std::string CsvWriter::reason() { return errno != 0 ? std::strerror(errno) : "no reason given"; }

void CsvWriter::flush() { hand_over(); }

void CsvWriter::close() {
  hand_over();
  out_.close();
  if (!out_) fail("{}: not all could be written ({}); is the disk full?", path_, reason());
}

CsvWriter::~CsvWriter() {
  try {
    hand_over();
  } catch (const Error&) {}  // said at the flush that was asked for, if at all
}

CsvTable read_csv(const std::string& path) {
  CsvTable table;
  std::string text = read_file(path);
  // a line without an end is one that its writer was killed in: what stands there may be half a number
  if (const std::size_t end = text.find_last_of('\n'); end != std::string::npos) text.resize(end + 1);
  table.rows = split(text, path);
  if (table.rows.empty()) fail("{}: is empty, must begin with a line of headers", path);
  table.headers = table.rows.front();
  table.rows.erase(table.rows.begin());
  for (std::size_t i = 0; i < table.rows.size(); ++i)
    if (table.rows[i].size() != table.headers.size())
      fail("{}: row {} has {} cells, must have {}", path, i + 1, table.rows[i].size(), table.headers.size());
  return table;
}

std::vector<std::string> CsvTable::column(const std::string& header) const {
  for (std::size_t c = 0; c < headers.size(); ++c) {
    if (headers[c] != header) continue;
    std::vector<std::string> out;
    for (const auto& row : rows) out.push_back(row[c]);
    return out;
  }
  fail("no column \"{}\"{}", header, suggestion(header, headers));
}

std::vector<double> CsvTable::numbers(const std::string& header) const {
  std::vector<double> out;
  for (const std::string& cell : column(header)) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (error != std::errc{} || end != cell.data() + cell.size())
      fail("column \"{}\", row {}: \"{}\" is no number", header, out.size() + 1, cell);
    out.push_back(value);
  }
  return out;
}

}  // namespace palpate::store
