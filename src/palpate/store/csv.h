#pragma once
#include <cstdint>
#include <fstream>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "palpate/core/archive.h"
#include "palpate/store/content_hash.h"

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
    std::string content;  ///< hash of these bytes
    void archive(Archive& a);
  };
  /// Goes on with a file that a writer with these headers began: what stands behind the place is cut off.
  /// @throws Error where the file does not reach to there, or is not what was written
  CsvWriter(const std::string& path, std::vector<std::string> headers, const Place& place);
  /// Flushes.  @throws Error when the disk refused anything
  Place place();
  const std::string& path() const { return path_; }
  void row(std::span<const double> values);
  void row(const std::vector<CsvCell>& cells);
  void flush();  ///< whole lines reach the file; one that a killed process leaves behind is passed over by
                 ///< read_csv()  @throws Error when the disk refuses
  void close();  ///< @throws Error when the disk refused anything
  CsvWriter(CsvWriter&&) = default;
  ~CsvWriter();  ///< as close(), without a word
  int rows() const { return rows_; }

 private:
  void end_row(std::size_t cells);
  void hand_over();
  static std::string reason();
  std::string path_;
  std::size_t columns_ = 0;
  int rows_ = 0;
  std::string line_;   ///< the row that is being made
  std::string lines_;  ///< rows that wait to be written together
  ContentHash content_;
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
/// A last line without an end does not count: its writer was killed in it.
CsvTable read_csv(const std::string& path);

}  // namespace palpate::store
