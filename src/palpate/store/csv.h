#pragma once
#include <cstdint>
#include <fstream>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "palpate/core/archive.h"

namespace palpate::store {

using CsvCell = std::variant<double, std::string>;

/// Comma-separated values with one line of headers; headers carry units (`force_x_n`).  Numbers are written
/// so that they read back exactly; NaN is `nan`.
class CsvWriter {
 public:
  CsvWriter(const std::string& path, std::vector<std::string> headers);
  /// Where a writer was, for another one to go on from.
  struct Place {
    std::int64_t bytes = 0;
    int rows = 0;
    void archive(Archive& a);
  };
  /// Goes on with a file that a writer with these headers began: what stands behind the place is cut off.
  /// @throws Error where the file does not reach to there
  CsvWriter(const std::string& path, std::vector<std::string> headers, const Place& place);
  /// Flushes.  @throws Error when the disk refused anything
  Place place();
  const std::string& path() const { return path_; }
  void row(std::span<const double> values);
  void row(const std::vector<CsvCell>& cells);
  void flush();
  void close();  ///< @throws Error when the disk refused anything
  int rows() const { return rows_; }

 private:
  void end_row(std::size_t cells);
  std::string path_;
  std::size_t columns_ = 0;
  int rows_ = 0;
  std::string line_;
  std::ofstream out_;
};

struct CsvTable {
  std::vector<std::string> headers;
  std::vector<std::vector<std::string>> rows;
  /// @throws Error with the nearest header
  std::vector<std::string> column(const std::string& header) const;
  /// @throws Error for a cell that is no number
  std::vector<double> numbers(const std::string& header) const;
};
CsvTable read_csv(const std::string& path);

}  // namespace palpate::store
