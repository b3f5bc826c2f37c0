#include "experiments/unfinished_tasks.h"

#include <algorithm>
#include <filesystem>

#include "experiments/result_store.h"
#include "palpate/core/error.h"
#include "store/result_db.h"

namespace palpate::experiments {
namespace fs = std::filesystem;
using store::ResultDb;

UnfinishedTasks::UnfinishedTasks(std::string folder, const std::vector<Task>& tasks,
                                 std::vector<std::string> lists)
    : folder_(std::move(folder)), lists_(std::move(lists)) {
  for (const Task& task : tasks) limits_s_.emplace(task.key, task.limit_s);
}

std::size_t UnfinishedTasks::count() {
  std::error_code none;
  for (fs::directory_iterator at(fs::path(folder_) / "tasks", none), end; at != end; at.increment(none)) {
    const fs::path path = at->path();
    if (path.extension() != ".db") continue;
    // An element that was queued again completes its file a second time.
    const auto changed = fs::last_write_time(path, none).time_since_epoch().count();
    if (!read_.insert(fmt::format("{} {}", path.string(), changed)).second) continue;
    try {
      read(path.string());
    } catch (const Error&) {}  // Renamed meanwhile, or damaged: the tasks stay without a result.
  }
  return limits_s_.size();
}

bool UnfinishedTasks::all_ended() {
  const auto is_complete = [this](const std::string& list) {
    std::error_code none;
    return fs::exists(ResultStore::element_file(folder_, list), none);
  };
  return count() == 0 || (!lists_.empty() && std::all_of(lists_.begin(), lists_.end(), is_complete));
}

void UnfinishedTasks::read(const std::string& path) {
  const ResultDb db(path, ResultDb::Access::kSingle);
  for (const std::string& key : db.keys()) {
    const auto task = limits_s_.find(key);
    if (task == limits_s_.end()) continue;
    const auto row = db.find(key);
    if (row && (status_of(row->status) != Status::kOutOfTime || row->limit_s >= task->second))
      limits_s_.erase(task);
  }
}

}  // namespace palpate::experiments
