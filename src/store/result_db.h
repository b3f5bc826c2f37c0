#pragma once
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpate::store {

/// Machine and version that made a result.
struct Machine {
  std::string host, cpu, cores, system, palpate, commit, ended_utc;

  /// Returns the present machine, at the present time.
  static Machine here();
  /// Returns names and values.
  std::array<std::pair<const char*, std::string*>, 7> fields() {
    return {{{"host", &host},
             {"cpu", &cpu},
             {"cores", &cores},
             {"system", &system},
             {"palpate", &palpate},
             {"commit", &commit},
             {"ended_utc", &ended_utc}}};
  }
};

/// Result of one task: a row of the table `result`.
struct ResultRow {
  std::string key;             ///< Hash of everything that determines the result.
  std::string kind, task;      ///< Kind of work; the task in words, or the command that runs it alone.
  std::string status, reason;  ///< "ok", or the failure and its reason.
  double cpu_s = 0.0;          ///< CPU time of the measured part [s].
  double limit_s = 0.0;        ///< Limit of the CPU time that the task had [s].
  Machine machine;
  std::string bytes;  ///< Content, for the program that made it.
};

/// Results of tasks in one SQLite file (`sqlite3 results.db 'select task, status, cpu_s from result'`).  Each
/// put() is one transaction, on disk before it returns: a process killed at any time leaves a readable file
/// with all earlier puts.
class ResultDb {
 public:
  enum class Access {
    kWrite,
    kRead,  ///< The file must exist.  A put() that a kill has interrupted is undone.
    /// Without locks of SQLite: for a file that only one process opens, also on a file system without locks.
    kSingle,
  };
  /// Opens or creates a database; ":memory:" keeps nothing.
  /// @throws Error where the file is no such database, or has other columns
  explicit ResultDb(const std::string& path, Access access = Access::kWrite);
  ~ResultDb();
  ResultDb(const ResultDb&) = delete;
  ResultDb& operator=(const ResultDb&) = delete;

  void put(const ResultRow& row);  ///< Replaces the row of the same key.
  std::optional<ResultRow> find(const std::string& key) const;
  std::vector<std::string> keys() const;
  long count() const;  ///< Number of rows.
  /// Copies all rows of another database, in one transaction.
  /// @throws Error where one of the two fails; this database then is as before
  void put_all(const ResultDb& other);
  /// Reads all rows.  @throws Error where the file is damaged
  void check_readable() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::store
