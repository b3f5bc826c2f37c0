#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace palpate::store {

/// Run of a study: a row of the table `run`.
struct StudyRun {
  std::string key;  ///< ContentHash of everything that determines the result.
  int repeat = 0;   ///< Index of the repetition, for the spread of the CPU time.
  std::string scene, label, integrator, setting_name;
  double setting = 0.0;
  std::string status, reason;   ///< "ok", or the failure and its reason.
  std::vector<double> numbers;  ///< Values of the database's number columns; NaN is NULL.
};

/// Large intermediate result that a study needs again, such as a reference trajectory: a row of the table
/// `artefact`.
struct StudyArtefact {
  std::string key, what, status, reason;
  double cpu_s = 0.0;
  std::string bytes;
};

/// Database of a study: one SQLite file (`sqlite3 study.sqlite 'select * from run'`).  Each put() is one
/// transaction, on disk before it returns: a process killed at any time leaves a readable file with all
/// earlier puts.
class StudyDb {
 public:
  /// Opens or creates the database.
  /// @param numbers  names of the columns of StudyRun::numbers
  /// @throws Error where the file is no such database, or has other columns
  StudyDb(const std::string& path, const std::vector<std::string>& numbers);
  ~StudyDb();
  StudyDb(const StudyDb&) = delete;
  StudyDb& operator=(const StudyDb&) = delete;

  void put(const StudyRun& run);                             ///< Replaces the row of the same key and repeat.
  std::vector<StudyRun> runs(const std::string& key) const;  ///< All repeats of a key, in ascending order.
  void put(const StudyArtefact& artefact);
  std::optional<StudyArtefact> artefact(const std::string& key) const;
  long run_count() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::store
