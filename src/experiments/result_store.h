#pragma once
#include <memory>
#include <optional>
#include <string>

#include "experiments/task.h"
#include "store/folder_lock.h"
#include "store/result_db.h"

namespace palpate::experiments {

/// Results in the folder of an experiment.
///
///   FOLDER/results.db         written by the one command that works in the folder
///   FOLDER/tasks/LIST.db      results of `--task LIST`, as an element of an array job; complete
///   FOLDER/tasks/LIST.db.part the same, while it is written
///   FOLDER/tasks/LIST.lock    locked while `--task LIST` runs
///   FOLDER/tasks/*.damaged    file of an element that could not be read
///
/// Only one process ever opens a file that is being written, so the folder may lie on a network file system.
/// Files in `tasks` are copied into results.db, and removed, by the next command without --task.
class ResultStore {
 public:
  /// Keeps results in memory.
  ResultStore();
  /// Opens the folder for a command that runs tasks here.  @param fresh  removes all earlier results
  /// @throws Error where elements of an array job are writing
  static ResultStore here(const std::string& folder, bool fresh);
  /// Opens the folder for an element that runs the tasks in `list`; close() completes its file.  Waits for a
  /// command that copies results, one minute at most.
  /// @throws Error where these tasks already run
  static ResultStore element(const std::string& folder, const std::string& list);
  /// Returns the path of the complete file of an element.
  static std::string element_file(const std::string& folder, const std::string& list);
  /// Opens the folder to read its results; while no element runs, also of those that were killed.
  /// @param all_ended  no element runs, even where the file system has no locks that tell so
  static ResultStore read(const std::string& folder, bool all_ended = false);
  ResultStore(ResultStore&&) = default;
  ResultStore& operator=(ResultStore&&) = default;
  ~ResultStore();

  /// Returns the result of an earlier task.
  std::optional<Result> find(const std::string& key) const;
  void put(const Task& task, const Result& result);
  void close();

 private:
  std::string folder_;
  store::FolderLock tasks_lock_, list_lock_;
  std::unique_ptr<store::ResultDb> main_;   ///< results.db; null where there is none.
  std::unique_ptr<store::ResultDb> extra_;  ///< The element's file; in read(): a copy of all, in memory.
  std::string element_;                     ///< Path of the element's complete file.
};

}  // namespace palpate::experiments
