#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::report {

using Rows = std::vector<std::vector<std::string>>;

/// Table of text cells with named columns: one CSV file, or one table of the page. Every row has as many
/// cells as there are headers.
struct Table {
  std::vector<std::string> headers = {};
  Rows rows = {};
  std::string source = {};  ///< Origin of the table, for messages

  /// Returns whether there is a column of that name.
  bool has(std::string_view header) const;
  /// Returns the index of a column.
  /// @throws Error with `source` and the nearest known column
  std::size_t column(std::string_view header) const;
  /// Returns a column as numbers; an empty or non-numeric cell is NaN.
  std::vector<double> numbers(std::string_view header) const;
  /// Returns a cell.
  const std::string& cell(std::size_t row, std::string_view header) const;
  /// Returns whether a column has a finite number above `limit`; false if there is no such column.
  bool exceeds(std::string_view header, double limit) const;
};

/// Returns the lines whose cell in `column` is `value`; all lines if there is no such column.
Table rows_where(const Table& table, const std::string& column, const std::string& value);
/// Returns the distinct values of a column, in the order of the lines.
std::vector<std::string> distinct(const Table& table, const std::string& column);

/// Reads a CSV file that store wrote, or one with the same format.
/// @throws Error with file and row for a row that is longer or shorter than the header, and for an unclosed
/// quote
Table read_csv(const std::filesystem::path& path);

/// Returns the number in a cell, independent of the locale; NaN if the cell is not exactly one number.
double to_number(std::string_view cell);

/// Returns a number with at most `digits` significant digits, as short as possible: 0.0123, 12.3, 4.56e-07;
/// "-" for NaN, "∞" and "-∞" for infinity.
std::string short_number(double value, int digits = 3);
/// Returns a figure with its acceptance range: "0.83 in [0.8, 1.2]"; "0.83, at least 0.8" if the other end is
/// NaN or infinite; "0.83" if both are.
std::string within_text(double value, double low, double high);

/// Returns a cell as shown: a number that is not finite as in short_number(), everything else unchanged.
std::string shown_cell(const std::string& cell);
/// Returns a cell for a reader: a number in short_number(), whole numbers and words unchanged, "-" for a
/// blank cell.
std::string short_cell(const std::string& cell);
/// Returns whether a cell is "yes", "true" or "1".
bool is_yes(std::string_view cell);
/// Returns whether a cell has no value: empty, "-", or NaN.
bool is_blank(std::string_view cell);

/// Returns aligned text for the terminal: two blanks between columns, a rule under the headers, numbers
/// aligned to the right, words to the left. Width is counted in code points, so that Greek letters and dashes
/// do not shift the columns. Cells are formatted by shown_cell().
std::string format_table(const std::vector<std::string>& headers, Rows rows);

/// Returns the rows of a table in which no line of format_table() is longer than `width`: a text in the last
/// column that is too long continues on rows whose other cells are empty.
/// @param width  characters per line; at most 20 more than the other columns take: no line is broken
Rows with_broken_lines(const std::vector<std::string>& headers, const Rows& rows, std::size_t width);

/// Returns whether every cell that is neither empty nor "-" is a number, and there is at least one number:
/// such a column is aligned to the right.
bool is_numeric_column(const Rows& rows, std::size_t column);

}  // namespace palpate::report
