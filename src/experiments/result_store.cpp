#include "experiments/result_store.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "core/clock.h"
#include "palpate/core/error.h"
#include "palpate/core/log.h"
#include "store/content_hash.h"

namespace palpate::experiments {
namespace {

namespace fs = std::filesystem;
using store::FolderLock;
using store::ResultDb;
using Access = ResultDb::Access;

constexpr const char *kPart = ".part", *kDamaged = ".damaged", *kLock = ".lock";
constexpr double kLongestWaitSeconds = 60.0;

fs::path main_path(const std::string& folder) { return fs::path(folder) / "results.db"; }
fs::path tasks_path(const std::string& folder) { return fs::path(folder) / "tasks"; }

/// Returns the entries of `tasks` whose names end so, in a fixed order.
std::vector<fs::path> files_ending(const std::string& folder, const std::vector<std::string>& ends) {
  std::vector<fs::path> out;
  std::error_code none;
  for (fs::directory_iterator at(tasks_path(folder), none), end; at != end; at.increment(none)) {
    const std::string name = at->path().filename().string();
    if (std::any_of(ends.begin(), ends.end(), [&](const std::string& one) { return name.ends_with(one); }))
      out.push_back(at->path());
  }
  std::sort(out.begin(), out.end());
  return out;
}

/// Returns the files of elements.
std::vector<fs::path> element_files(const std::string& folder, bool with_parts) {
  return files_ending(folder,
                      with_parts ? std::vector<std::string>{".db", kPart} : std::vector<std::string>{".db"});
}

/// Copies the results of an element.  Its tasks are run again where the file cannot be read: a failing disk
/// may have damaged it.
/// @return whether the file could be read  @throws Error where `to` cannot be written
bool copy_element(const fs::path& file, ResultDb& to) {
  std::unique_ptr<ResultDb> from;
  try {
    from = std::make_unique<ResultDb>(file.string(), Access::kSingle);
    from->check_readable();
  } catch (const Error& damaged) {
    log::warn("{}", damaged.what());
    return false;
  }
  to.put_all(*from);
  return true;
}

void remove_file(const fs::path& path) {
  std::error_code failed;
  fs::remove_all(path, failed);
  if (failed) fail("{}: cannot be removed: {}", path.string(), failed.message());
}

/// Renames an unreadable file, and the journal that SQLite may have left beside it.
void set_aside(const fs::path& file) {
  const std::string kept = file.string() + kDamaged;
  std::error_code none, failed;
  fs::rename(file.string() + "-journal", kept + "-journal", none);
  fs::rename(file, kept, failed);
  if (failed) fail("{}: cannot be renamed to {}: {}", file.string(), kept, failed.message());
  log::warn("{}: its results cannot be read, and are kept in {}", file.string(), kept);
}

/// Copies the results of elements into results.db, and removes the files that were copied.
void merge_elements(const std::string& folder, bool with_parts, ResultDb& to) {
  for (const fs::path& file : element_files(folder, with_parts))
    if (copy_element(file, to))
      remove_file(file);
    else
      set_aside(file);
  for (const fs::path& lock : files_ending(folder, {kLock})) remove_file(lock);
}

/// Locks the folder of the elements' files.  @return nothing where another process uses it
std::optional<FolderLock> lock_alone(const std::string& folder) {
  try {
    return FolderLock(tasks_path(folder).string());
  } catch (const Error&) { return std::nullopt; }
}

/// Returns a file name for a list of tasks.
std::string name_of(const std::string& list) {
  return list.size() <= 100 ? list : store::ContentHash().add(list).hex();
}

/// Locks the folder of the elements' files together with other elements.  Waits, since a command that copies
/// results holds it for some seconds.
FolderLock lock_shared(const fs::path& tasks) {
  FolderLock::make(tasks.string());
  const double start = wall_seconds();
  while (true) try {
      return FolderLock(tasks.string(), FolderLock::Access::kShared);
    } catch (const Error&) {
      if (wall_seconds() - start > kLongestWaitSeconds) throw;
      usleep(100000);
    }
}

/// Locks a list of tasks, by a folder that is removed with the element's file: an element that starts the
/// same list later must find the same folder.
FolderLock lock_list(const fs::path& tasks, const std::string& list) {
  const std::string path = (tasks / (name_of(list) + kLock)).string();
  FolderLock::make(path);
  try {
    return FolderLock(path);
  } catch (const Error& busy) { fail("these tasks already run, --task {}: {}", list, busy.what()); }
}

}  // namespace

ResultStore::ResultStore() : main_(std::make_unique<ResultDb>(":memory:")) {}

ResultStore ResultStore::here(const std::string& folder, bool fresh) {
  ResultStore out;
  out.folder_ = folder;
  out.tasks_lock_ = FolderLock(tasks_path(folder).string());
  if (fresh) {
    remove_file(main_path(folder));
    for (const auto& entry : fs::directory_iterator(tasks_path(folder))) remove_file(entry.path());
  }
  out.main_ = std::make_unique<ResultDb>(main_path(folder).string());
  merge_elements(folder, true, *out.main_);
  return out;
}

ResultStore ResultStore::element(const std::string& folder, const std::string& list) {
  ResultStore out;
  out.folder_ = folder;
  const fs::path tasks = tasks_path(folder);
  out.tasks_lock_ = lock_shared(tasks);
  out.list_lock_ = lock_list(tasks, list);
  out.element_ = element_file(folder, list);
  // The element's own earlier results, after a requeue.
  if (fs::exists(out.element_)) fs::rename(out.element_, out.element_ + kPart);
  out.extra_ = std::make_unique<ResultDb>(out.element_ + kPart, Access::kSingle);
  out.main_.reset();
  if (fs::exists(main_path(folder)))
    out.main_ = std::make_unique<ResultDb>(main_path(folder).string(), Access::kRead);
  return out;
}

std::string ResultStore::element_file(const std::string& folder, const std::string& list) {
  return (tasks_path(folder) / (name_of(list) + ".db")).string();
}

ResultStore ResultStore::read(const std::string& folder, bool all_ended) {
  ResultStore out;
  out.extra_ = std::make_unique<ResultDb>(":memory:");
  out.main_.reset();
  if (!element_files(folder, true).empty()) {
    if (const auto lock = lock_alone(folder)) {
      ResultDb all(main_path(folder).string());
      // With the lock, what an element has left incomplete belongs to no process.
      const bool none_runs = all_ended || lock->is_locked();
      merge_elements(folder, none_runs, all);
      if (std::error_code not_empty; none_runs) fs::remove(tasks_path(folder), not_empty);
    } else {
      for (const fs::path& file : element_files(folder, false)) copy_element(file, *out.extra_);
    }
  }
  if (fs::exists(main_path(folder)))
    out.main_ = std::make_unique<ResultDb>(main_path(folder).string(), Access::kRead);
  return out;
}

ResultStore::~ResultStore() {
  std::error_code not_empty;
  if (!folder_.empty()) fs::remove(tasks_path(folder_), not_empty);
}

std::optional<Result> ResultStore::find(const std::string& key) const {
  std::optional<store::ResultRow> row;
  if (extra_) row = extra_->find(key);
  if (!row && main_) row = main_->find(key);
  if (!row) return std::nullopt;
  Result out;
  out.status = status_of(row->status);
  out.reason = row->reason;
  out.cpu_s = row->cpu_s;
  out.bytes = row->bytes;
  out.limit_s = row->limit_s;
  out.machine = row->machine;
  return out;
}

void ResultStore::put(const Task& task, const Result& result) {
  ResultDb* to = element_.empty() ? main_.get() : extra_.get();
  PALPATE_CHECK(to, "{}: opened to read its results", folder_);
  to->put({task.key, task.kind, task.name, to_string(result.status), result.reason, result.cpu_s,
           result.limit_s, result.machine, result.bytes});
}

void ResultStore::close() {
  main_.reset();
  extra_.reset();
  if (!element_.empty()) fs::rename(element_ + kPart, element_);
  element_.clear();
  list_lock_ = {};
  tasks_lock_ = {};
}

}  // namespace palpate::experiments
