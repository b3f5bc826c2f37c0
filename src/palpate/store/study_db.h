#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace palpate::store {

/// One run of a study: a row of the table `run`.
struct StudyRun {
  std::string key;  ///< of everything that decides the result (ContentHash)
  int repeat = 0;   ///< the same run again, for the spread of its time
  std::string scene, label, integrator, setting_name;
  double setting = 0.0;
  std::string status, reason;   ///< "ok", or what happened and why
  std::vector<double> numbers;  ///< under the columns that the database was opened with; NaN is NULL
};

/// Something large that a study needs again, such as a reference trajectory: a row of the table `artefact`.
struct StudyArtefact {
  std::string key, what, status, reason;
  double cpu_s = 0.0;
  std::string bytes;
};

/// A study on disk: one SQLite file (`sqlite3 study.sqlite 'select * from run'`).  Every put is one
/// transaction, on disk before it returns: a process killed at any moment leaves a readable file with all
/// that was put before.
class StudyDb {
 public:
  /// Opens or makes it.  @param numbers  names of the columns of StudyRun::numbers
  /// @throws Error where the file is no such database, or was made with other columns
  StudyDb(const std::string& path, const std::vector<std::string>& numbers);
  ~StudyDb();
  StudyDb(const StudyDb&) = delete;
  StudyDb& operator=(const StudyDb&) = delete;

  void put(const StudyRun& run);                             ///< replaces the row of the same key and repeat
  std::vector<StudyRun> runs(const std::string& key) const;  ///< in the order of their repeats
  void put(const StudyArtefact& artefact);
  std::optional<StudyArtefact> artefact(const std::string& key) const;
  long run_count() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::store
