#pragma once
#include <cstdint>
#include <fstream>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "palpate/core/archive.h"
#include "store/content_hash.h"

namespace palpate::store {

/// Cell of a CSV row.
using CsvCell = std::variant<double, std::string>;

/// Writer of comma-separated values with one header line; headers carry units (`force_x_n`).  Numbers are
/// written so that they read back exactly; NaN is `nan`.
class CsvWriter {
 public:
  /// Creates the file.  @throws Error where it cannot be written
  CsvWriter(const std::string& path, std::vector<std::string> headers);
  /// Position of a writer, from which another one can resume.
  struct Place {
    std::int64_t bytes = 0;  ///< Size of the file.
    int rows = 0;            ///< Number of rows.
    std::string content;     ///< Hash of these bytes.
    void archive(Archive& a);
  };
  /// Resumes a file that a writer with these headers began: data behind the place are discarded.
  /// @throws Error where the file is shorter, or differs from the data written
  CsvWriter(const std::string& path, std::vector<std::string> headers, const Place& place);
  /// Flushes and returns the present position.  @throws Error when writing failed
  Place place();
  const std::string& path() const { return path_; }
  void row(std::span<const double> values);
  void row(const std::vector<CsvCell>& cells);
  /// Writes complete lines to the file.  read_csv() skips the incomplete last line of a killed process.
  /// @throws Error when writing fails
  void flush();
  void close();  ///< Flushes and closes.  @throws Error when writing failed
  CsvWriter(CsvWriter&&) = default;
  ~CsvWriter();  ///< Flushes; errors are ignored.
  int rows() const { return rows_; }

 private:
  void end_row(std::size_t cells);
  void hand_over();
  static std::string reason();
  std::string path_;
  std::size_t columns_ = 0;
  int rows_ = 0;
  std::string line_;   ///< Row in progress.
  std::string lines_;  ///< Complete rows, not yet written.
  ContentHash content_;
  std::ofstream out_;
};

/// Content of a CSV file, as text.
struct CsvTable {
  std::vector<std::string> headers;
  std::vector<std::vector<std::string>> rows;
  /// Returns the cells of a column.  @throws Error that suggests the nearest header
  std::vector<std::string> column(const std::string& header) const;
  /// Returns a column as numbers.  @throws Error for a cell that is no number
  std::vector<double> numbers(const std::string& header) const;
};
/// Reads a CSV file.  A last line without a line end is ignored: its writer was killed.
CsvTable read_csv(const std::string& path);

}  // namespace palpate::store
