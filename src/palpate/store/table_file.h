#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace palpate::store {

/// A table's name and its columns; names carry units.
struct TableSpec {
  std::string name;
  std::vector<std::string> columns;
};

/// An HDF5 file of tables that grow by rows of doubles, each a data set (rows, columns) with the attribute
/// "columns".  What was flushed is whole, whatever happens to the process later.
class TableFile {
 public:
  /// @throws Error when the file cannot be made
  TableFile(const std::string& path, const std::vector<TableSpec>& tables);

  /// With a journal, PATH.rows: every row stands there too, one behind the other.  A kill while HDF5 changes
  /// its file can leave that unreadable; a journal that was cut off is whole up to there, and the file is
  /// made anew from it.
  struct Journal {
    std::int64_t bytes = 0;  ///< of the journal so far; 0: from the start
    std::string content;     ///< hash of these bytes
  };
  /// @param from  where rows go on: those before are taken from the journal, what is behind is cut off
  /// @throws Error where the journal does not reach to there, or is not what was written
  TableFile(const std::string& path, const std::vector<TableSpec>& tables, const Journal& from);
  /// Flushes both.  @throws Error when the disk refuses
  Journal place();
  static std::string journal_path(const std::string& path) { return path + ".rows"; }
  ~TableFile();
  /// @param table  its number in the list  @throws Error when the disk refuses
  void append(std::size_t table, std::span<const double> row);
  void flush();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A table as read: row-major.
struct Table {
  std::vector<std::string> columns;
  std::vector<double> values;
  std::size_t rows() const { return columns.empty() ? 0 : values.size() / columns.size(); }
  std::span<const double> row(std::size_t i) const {
    return std::span(values).subspan(i * columns.size(), columns.size());
  }
};

/// @throws Error for a file without it
Table read_table(const std::string& path, const std::string& name);

}  // namespace palpate::store
