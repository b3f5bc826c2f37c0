#include "store/csv.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <string_view>
#include <utility>

#include "core/csv.h"
#include "core/whole_number.h"
#include "palpate/core/error.h"
#include "store/atomic_file.h"

namespace palpate::store {
namespace {

/// Appends a cell by RFC 4180: in quotes where read_csv_text() would misread it, with inner quotes doubled.
void append_text(std::string& line, const std::string& text) {
  constexpr std::string_view kBlanks = " \t";
  const bool blank_at_an_end = !text.empty() && (kBlanks.find(text.front()) != std::string_view::npos ||
                                                 kBlanks.find(text.back()) != std::string_view::npos);
  if (text.find_first_of(",;\t\"\r\n") == std::string::npos && !blank_at_an_end) {
    line += text;
    return;
  }
  line += '"';
  for (const char c : text) line.append(c == '"' ? 2 : 1, c);
  line += '"';
}

void append_number(std::string& line, double value) { fmt::format_to(std::back_inserter(line), "{}", value); }

}  // namespace

CsvWriter::CsvWriter(const std::string& path, std::vector<std::string> headers)
    : path_(path), columns_(headers.size()) {
  out_.rdbuf()->pubsetbuf(nullptr, 0);  // Unbuffered: complete lines are collected here.
  errno = 0;
  out_.open(path, std::ios::binary | std::ios::trunc);
  if (!out_)
    fail("{}: cannot be written ({}); check that its folder exists, is writable and is not full", path,
         reason());
  for (const std::string& header : headers) {
    append_text(line_, header);
    line_ += ',';
  }
  end_row(headers.size());
  rows_ = 0;
}

CsvWriter::CsvWriter(const std::string& path, std::vector<std::string> headers, const Place& place)
    : path_(path), columns_(headers.size()), rows_(place.rows) {
  check_reaches(path, place.bytes);
  content_.add_part(std::string_view(read_file(path)).substr(0, static_cast<std::size_t>(place.bytes)));
  check_content(path, content_, place.content);
  truncate_file(path, place.bytes);
  out_.rdbuf()->pubsetbuf(nullptr, 0);
  errno = 0;
  out_.open(path, std::ios::binary | std::ios::app);
  if (!out_)
    fail("{}: cannot be written ({}); check that its folder exists, is writable and is not full", path,
         reason());
}

CsvWriter::Place CsvWriter::place() {
  hand_over();
  return {static_cast<std::int64_t>(std::filesystem::file_size(path_)), rows_, content_.hex()};
}

void CsvWriter::Place::archive(Archive& a) {
  a("bytes", bytes);
  a("rows", rows);
  a("content", content);
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
  content_.add_part(lines_);
  lines_.clear();
  if (!out_) fail("{}: cannot be written further ({}); is the disk full?", path_, reason());
}

std::string CsvWriter::reason() { return errno != 0 ? std::strerror(errno) : "no reason given"; }

void CsvWriter::flush() { hand_over(); }

void CsvWriter::close() {
  hand_over();
  out_.close();
  if (!out_) fail("{}: could not be written completely ({}); is the disk full?", path_, reason());
}

CsvWriter::~CsvWriter() {
  try {
    hand_over();
  } catch (const Error&) {}  // Reported by an explicit flush, if at all.
}

CsvTable read_csv(const std::string& path) {
  CsvTable table;
  std::string text = read_file(path);
  // A last line without an end was cut off when its writer was killed, and may hold half a number.
  if (const std::size_t end = text.find_last_of('\n'); end != std::string::npos) text.resize(end + 1);
  for (CsvRow& row : read_csv_text(text, path)) table.rows.push_back(std::move(row.cells));
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
    if (!read_csv_number(cell, value))
      fail("column \"{}\", row {}: \"{}\" is not a number", header, out.size() + 1, cell);
    if (beyond_whole(cell)) fail("column \"{}\", row {}: {} {}", header, out.size() + 1, cell, kWholeDemand);
    out.push_back(value);
  }
  return out;
}

}  // namespace palpate::store
