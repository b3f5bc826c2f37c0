#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::report {

/// Text cells under named columns: one CSV file, or one table of the page.
/// Every row has as many cells as there are headers.
struct Table {
  std::vector<std::string> headers = {};
  std::vector<std::vector<std::string>> rows = {};
  std::string source = {};  ///< where it came from, for messages

  bool has(std::string_view header) const;
  /// Index of a column; throws Error naming `source` and the nearest known column.
  std::size_t column(std::string_view header) const;
  /// A whole column as numbers; an empty or non-numeric cell is NaN.
  std::vector<double> numbers(std::string_view header) const;
};

/// Reads a CSV file that store wrote, or one like it.  Throws Error with file and row for a row that is
/// longer or shorter than the header, and for a quote that is never closed.
Table read_csv(const std::filesystem::path& path);

/// The number in a cell, locale-free; NaN when the cell is not exactly one number.
double to_number(std::string_view cell);

/// At most `digits` significant digits, as short as they come: 0.0123, 12.3, 4.56e-07; "-" for NaN, "∞" and
/// "-∞".
std::string short_number(double value, int digits = 3);
/// A figure and the range that it must lie in: "0.83 in [0.8, 1.2]"; "0.83, at least 0.8" where the other end
/// is NaN or infinite; "0.83" where both are.
std::string within_text(double value, double low, double high);

/// A cell as people see it: a number that is not finite as short_number() writes it, all else as it is.
std::string shown_cell(const std::string& cell);
/// True of "yes", "true" and "1".
bool is_yes(std::string_view cell);
/// True when a cell holds no value: empty, "-", or NaN.
bool is_blank(std::string_view cell);

/// Aligned text for the terminal: two blanks between columns, a rule under the headers, numbers to the right,
/// words to the left.  Width is counted in code points, so that Greek letters and dashes do not shift the
/// columns.  Cells are written as shown_cell() has them.
std::string format_table(const std::vector<std::string>& headers, std::vector<std::vector<std::string>> rows);

/// True when every cell that is neither empty nor "-" is a number, and there is at least one: such a column
/// is set to the right.
bool is_numeric_column(const std::vector<std::vector<std::string>>& rows, std::size_t column);

}  // namespace palpate::report
