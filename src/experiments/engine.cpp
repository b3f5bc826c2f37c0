#include "experiments/engine.h"

#include <signal.h>

#include <algorithm>
#include <list>
#include <map>
#include <numeric>
#include <optional>
#include <thread>

#include "core/archive_bytes.h"
#include "experiments/indices.h"
#include "loop/result_key.h"
#include "palpate/core/error.h"
#include "store/content_hash.h"

namespace palpate::experiments {
namespace {

using Outcome = ProcessPool::Outcome;

/// Whether the process was ended from outside: by a node that goes down, an administrator, or the kernel when
/// it runs out of memory.  Other signals are crashes of the task.
bool is_from_outside(int signal) { return signal == SIGKILL || signal == SIGTERM || signal == SIGHUP; }

Result result_of(const Outcome& outcome) {
  using End = Outcome::End;
  Result out;
  out.reason = outcome.bytes;
  switch (outcome.end) {
    case End::kDone: return restored<Result>(outcome.bytes);
    case End::kError:
      out.status = Status::kCrashed;
      out.reason = "internal error: " + outcome.bytes;
      break;
    case End::kCrash:
      out.status = is_from_outside(outcome.signal) ? Status::kMissing : Status::kCrashed;
      break;
    case End::kOutOfTime: out.status = Status::kOutOfTime; break;
    case End::kNoMemory: out.status = Status::kMissing; break;
  }
  return out;
}

class Engine {
 public:
  Engine(Experiment& experiment, ResultStore& store, const EngineOptions& options)
      : experiment_(experiment), store_(store), options_(options) {
    if (!options.submit) pool_.emplace(options.jobs);
    std::vector<std::size_t> all;
    if (!options.only || experiment.has_dependencies()) {
      all.resize(experiment.size());
      std::iota(all.begin(), all.end(), std::size_t{0});
    } else {
      all = *options.only;
    }
    all_ = options.only ? options.only->size() : all.size();
    for (const std::size_t i : all) open_.push_back({i});
  }

  EngineOutcome run() {
    while (!stopped()) {
      const bool moved = advance();
      if (open_.empty() && idle()) break;
      if (moved) continue;  // Results may have made other tasks ready.
      if (!idle())
        pool_->wait(0.2);
      else if (!options_.submit || !submit_ready())
        break;
    }
    PALPATE_CHECK(stopped() || open_.empty() || options_.submit || options_.only,
                  "nothing runs, and task {} cannot be started", open_.front().index);
    out_.stopped = stopped();
    out_.complete = open_.empty() && out_.lost.empty();
    for (const Open& open : open_)
      if (open.submitted)
        out_.lost.push_back({open.index, ""});
      else if (options_.only && !options_.submit && !out_.stopped && is_requested(open.index))
        out_.lost.push_back({open.index, "needs the result of another task"});
    return std::move(out_);
  }

 private:
  /// Task without a result.
  struct Open {
    std::size_t index;
    bool looked_up = false, submitted = false;
  };

  bool stopped() const { return options_.stop && options_.stop->load(); }
  bool idle() const { return !pool_ || pool_->idle(); }

  /// Drops tasks that are not wanted, takes stored results, and starts tasks as long as there is room;
  /// returns whether tasks ended.
  bool advance() {
    bool moved = false;
    for (auto at = open_.begin(); at != open_.end() && !stopped();) {
      const auto current = at++;
      if (!experiment_.is_wanted(current->index)) {
        ended_ += is_requested(current->index);
        open_.erase(current);
        moved = true;
        continue;
      }
      if (!experiment_.is_ready(current->index)) continue;
      const Task task = experiment_.task(current->index);
      if (reuse(*current, task)) {
        open_.erase(current);
        moved = true;
      } else if (may_run(*current)) {
        if (!has_room_for(task)) break;
        start(current->index, task);
        open_.erase(current);
      }
    }
    return moved;
  }

  bool is_requested(std::size_t i) const {
    return !options_.only || std::binary_search(options_.only->begin(), options_.only->end(), i);
  }

  bool may_run(const Open& open) const { return pool_ && is_requested(open.index); }

  bool has_room_for(const Task& task) const {
    return task.alone ? pool_->idle() : pool_->has_room() && !alone_runs_;
  }

  /// Takes the stored result of a task, if it has one.
  bool reuse(Open& open, const Task& task) {
    if (open.looked_up || task.key.empty()) return false;
    open.looked_up = true;
    const std::optional<Result> kept = store_.find(task.key);
    if (!kept || (kept->status == Status::kOutOfTime && kept->limit_s < task.limit_s)) return false;
    if (is_requested(open.index)) {
      ++out_.reused;
      ++ended_;
    }
    experiment_.take(open.index, *kept);
    return true;
  }

  void start(std::size_t index, const Task& task) {
    alone_runs_ = task.alone;
    pool_->start(task.work, experiment_.input(index), task.limit_s,
                 [this, index, task](const Outcome& outcome) { done(index, task, outcome); });
  }

  void done(std::size_t index, const Task& task, const Outcome& outcome) {
    alone_runs_ = false;
    if (stopped()) return;  // The task may have been interrupted.
    Result result = result_of(outcome);
    result.limit_s = task.limit_s;
    result.machine = store::Machine::here();
    if (result.status == Status::kMissing) {
      out_.lost.push_back({index, result.reason});
    } else {
      ++out_.run;
      if (!task.key.empty() && experiment_.is_final(index, result)) store_.put(task, result);
    }
    experiment_.take(index, result);
    report(index);
  }

  void report(std::size_t index) {
    ++ended_;
    if (options_.progress)
      options_.progress(static_cast<double>(ended_) / static_cast<double>(all_),
                        experiment_.progress_text(index));
  }

  /// Submits the groups with a task that is ready, but none that a job has left without a result; returns
  /// false where there are none, or the job is not waited for.
  bool submit_ready() {
    std::map<std::size_t, bool> submits;
    for (const Open& open : open_) {
      bool& wanted = submits[experiment_.group(open.index)];
      wanted |= !open.submitted && experiment_.is_ready(open.index);
    }
    for (const Open& open : open_)
      if (open.submitted) submits[experiment_.group(open.index)] = false;
    std::map<std::size_t, std::size_t> element_of;
    std::vector<std::vector<std::size_t>> elements;
    for (Open& open : open_) {
      const std::size_t group = experiment_.group(open.index);
      if (!submits[group]) continue;
      const auto [at, is_new] = element_of.emplace(group, elements.size());
      if (is_new) elements.emplace_back();
      elements[at->second].push_back(open.index);
      open.submitted = true;
    }
    if (elements.empty() || !options_.submit(experiment_, elements)) return false;
    for (Open& open : open_) open.looked_up = false;
    return true;
  }

  Experiment& experiment_;
  ResultStore& store_;
  const EngineOptions& options_;
  std::optional<ProcessPool> pool_;
  std::list<Open> open_;
  EngineOutcome out_;
  std::size_t ended_ = 0, all_ = 0;
  bool alone_runs_ = false;
};

}  // namespace

EngineOutcome run(Experiment& experiment, ResultStore& store, const EngineOptions& options) {
  return Engine(experiment, store, options).run();
}

EngineOutcome run(Experiment& experiment, const Place& place, EngineOptions options) {
  std::vector<std::size_t> only;
  const bool other_plan = !place.plan.empty() && place.plan != experiment.key();
  if (!place.tasks.empty()) {
    if (!other_plan) only = indices_of(place.tasks, experiment.size());
    options.only = &only;
  }
  options.submit = place.submit;
  std::optional<ResultStore> in_memory;
  if (!place.store) in_memory.emplace();
  EngineOutcome out = run(experiment, place.store ? *place.store : *in_memory, options);
  out.other_plan = other_plan;
  return out;
}

std::string key_of(std::initializer_list<std::string_view> words) {
  store::ContentHash hash;
  hash.add(loop::made_by());
  for (const std::string_view word : words) hash.add(word);
  return hash.hex();
}

int jobs_or_cores(int jobs) {
  return jobs > 0 ? jobs : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace palpate::experiments
