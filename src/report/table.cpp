#include "report/table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "core/csv.h"
#include "palpate/core/error.h"
#include "store/csv.h"

namespace palpate::report {

Table read_csv(const std::filesystem::path& path) {
  store::CsvTable file = store::read_csv(path.string());
  return {std::move(file.headers), std::move(file.rows), path.string()};
}

bool Table::has(std::string_view header) const {
  return std::find(headers.begin(), headers.end(), header) != headers.end();
}

std::size_t Table::column(std::string_view header) const {
  const auto it = std::find(headers.begin(), headers.end(), header);
  if (it == headers.end())
    fail("{}: has no column \"{}\"{}", source.empty() ? "table" : source, header,
         suggestion(header, headers));
  return static_cast<std::size_t>(it - headers.begin());
}

std::vector<double> Table::numbers(std::string_view header) const {
  const std::size_t c = column(header);
  std::vector<double> out;
  out.reserve(rows.size());
  for (const auto& row : rows) out.push_back(to_number(row[c]));
  return out;
}

const std::string& Table::cell(std::size_t row, std::string_view header) const {
  return rows[row][column(header)];
}

bool Table::exceeds(std::string_view header, double limit) const {
  if (!has(header)) return false;
  const std::vector<double> values = numbers(header);
  return std::any_of(values.begin(), values.end(),
                     [&](double value) { return std::isfinite(value) && value > limit; });
}

Table rows_where(const Table& table, const std::string& column, const std::string& value) {
  if (!table.has(column)) return table;
  Table out{table.headers, {}, table.source};
  const std::size_t c = table.column(column);
  std::copy_if(table.rows.begin(), table.rows.end(), std::back_inserter(out.rows),
               [&](const auto& row) { return row[c] == value; });
  return out;
}

std::vector<std::string> distinct(const Table& table, const std::string& column) {
  std::vector<std::string> out;
  const std::size_t c = table.column(column);
  for (const auto& row : table.rows)
    if (std::find(out.begin(), out.end(), row[c]) == out.end()) out.push_back(row[c]);
  return out;
}

double to_number(std::string_view cell) {
  double value = std::numeric_limits<double>::quiet_NaN();
  if (cell.find(',') == std::string_view::npos) read_csv_number(cell, value);  // decimal points only
  return value;
}

std::string short_number(double value, int digits) {
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return value > 0.0 ? "∞" : "-∞";
  return fmt::format("{:.{}g}", value, digits);
}

std::string within_text(double value, double low, double high) {
  const std::string text = short_number(value);
  const bool above = std::isfinite(low), below = std::isfinite(high);
  if (above && below) return fmt::format("{} in [{:g}, {:g}]", text, low, high);
  if (above) return fmt::format("{}, at least {:g}", text, low);
  return below ? fmt::format("{}, at most {:g}", text, high) : text;
}

std::string shown_cell(const std::string& cell) {
  double value = 0.0;
  return read_csv_number(cell, value) && !std::isfinite(value) ? short_number(value) : cell;
}

std::string short_cell(const std::string& cell) {
  if (is_blank(cell)) return "-";
  const double value = to_number(cell);
  return std::isnan(value)                                      ? cell
         : value == std::floor(value) && std::abs(value) < 1e15 ? fmt::format("{:.0f}", value)
                                                                : short_number(value);
}

bool is_yes(std::string_view cell) { return cell == "yes" || cell == "true" || cell == "1"; }

bool is_blank(std::string_view cell) {
  return cell.empty() || cell == "-" || shown_cell(std::string(cell)) == "-";
}

bool is_numeric_column(const Rows& rows, std::size_t column) {
  bool any = false;
  for (const auto& row : rows) {
    const std::string& cell = row[column];
    if (is_blank(cell)) continue;
    if (std::isnan(to_number(cell)) && !cell.ends_with("∞")) return false;
    any = true;
  }
  return any;
}

namespace {

/// Returns the number of code points of a UTF-8 text: all bytes except continuation bytes (10xxxxxx).
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

void append_padded(std::string& line, const std::string& cell, std::size_t width, bool to_the_right) {
  const std::string blanks(width - width_of(cell), ' ');
  line += to_the_right ? blanks + cell : cell + blanks;
}

/// Removes blanks at the end of a line: a terminal that is one column too narrow would otherwise show an
/// empty line after each.
std::string without_trailing_blanks(std::string line) {
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

}  // namespace

std::string format_table(const std::vector<std::string>& headers, Rows rows) {
  const std::size_t columns = headers.size();
  std::vector<std::size_t> widths(columns);
  for (std::size_t c = 0; c < columns; ++c) widths[c] = width_of(headers[c]);
  for (auto& row : rows) {
    PALPATE_CHECK(row.size() == columns, "a row of {} cells under {} headers", row.size(), columns);
    for (std::size_t c = 0; c < columns; ++c) {
      row[c] = shown_cell(row[c]);
      widths[c] = std::max(widths[c], width_of(row[c]));
    }
  }
  std::vector<bool> right(columns);
  for (std::size_t c = 0; c < columns; ++c) right[c] = is_numeric_column(rows, c);

  const auto line_of = [&](const std::vector<std::string>& cells) {
    std::string line;
    for (std::size_t c = 0; c < columns; ++c) {
      if (c > 0) line += "  ";
      append_padded(line, cells[c], widths[c], right[c]);
    }
    return without_trailing_blanks(line);
  };
  std::string text = line_of(headers);
  for (std::size_t c = 0; c < columns; ++c) text += (c > 0 ? "  " : "") + std::string(widths[c], '-');
  text += "\n";
  for (const auto& row : rows) text += line_of(row);
  return text;
}

Rows with_broken_lines(const std::vector<std::string>& headers, const Rows& rows, std::size_t width) {
  constexpr std::size_t kNarrowest = 20;
  std::size_t before = 0;
  for (std::size_t c = 0; c + 1 < headers.size(); ++c) {
    std::size_t widest = width_of(headers[c]);
    for (const auto& row : rows) widest = std::max(widest, width_of(row.at(c)));
    before += widest + 2;
  }
  if (width < before + kNarrowest) return rows;
  Rows out;
  for (const auto& row : rows) {
    std::istringstream words(row.back());
    std::string line;
    out.push_back(row);
    for (std::string word; words >> word;) {
      if (!line.empty() && width_of(line) + 1 + width_of(word) > width - before) {
        out.back().back() = line;
        out.emplace_back(headers.size());
        line.clear();
      }
      line += (line.empty() ? "" : " ") + word;
    }
    out.back().back() = line;
  }
  return out;
}

}  // namespace palpate::report
