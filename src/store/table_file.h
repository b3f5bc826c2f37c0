#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace palpate::store {

/// Name of a table and its columns; names carry units.
struct TableSpec {
  std::string name;
  std::vector<std::string> columns;
};

/// HDF5 file of tables that grow by rows of doubles; each is a data set (rows, columns) with the attribute
/// "columns".  Flushed rows are complete, whatever happens to the process later.
class TableFile {
 public:
  /// Creates the file.  @throws Error when that fails
  TableFile(const std::string& path, const std::vector<TableSpec>& tables);

  /// Position in the journal, PATH.rows, which holds every row in order of writing.  A kill while HDF5
  /// changes its file can make that file unreadable; a truncated journal is valid up to its end, and the file
  /// is rebuilt from it.
  struct Journal {
    std::int64_t bytes = 0;  ///< Size of the journal; 0: start anew.
    std::string content;     ///< Hash of these bytes.
  };
  /// Opens the file with a journal.
  /// @param from  place to resume at: earlier rows are restored from the journal, later ones discarded
  /// @throws Error where the journal is shorter, or differs from the data written
  TableFile(const std::string& path, const std::vector<TableSpec>& tables, const Journal& from);
  /// Flushes file and journal, and returns the position.  @throws Error when writing fails
  Journal place();
  static std::string journal_path(const std::string& path) { return path + ".rows"; }
  ~TableFile();
  /// Appends one row.  @param table  index in the list of tables  @throws Error when writing fails
  void append(std::size_t table, std::span<const double> row);
  void flush();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Content of a table, row-major.
struct Table {
  std::vector<std::string> columns;
  std::vector<double> values;
  std::size_t rows() const { return columns.empty() ? 0 : values.size() / columns.size(); }
  std::span<const double> row(std::size_t i) const {
    return std::span(values).subspan(i * columns.size(), columns.size());
  }
};

/// Reads a table.  @throws Error where the file has none of that name
Table read_table(const std::string& path, const std::string& name);

}  // namespace palpate::store
