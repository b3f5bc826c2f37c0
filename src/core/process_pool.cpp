#include "core/process_pool.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <vector>

#include "core/clock.h"
#include "palpate/core/error.h"
#include "socket_message.h"
#include "work_server.h"

namespace palpate {

using work_server::Notice;
using work_server::Request;

void ProcessPool::prepare() { work_server::prepare(); }

ProcessPool::ProcessPool(int jobs) : jobs_(std::max(1, jobs)), server_(work_server::connect()) {}

ProcessPool::~ProcessPool() {
  shutdown(server_, SHUT_WR);  // The server ends with all its processes; then its side closes.
  Notice notice;
  while (work_server::receive_bytes(server_, &notice, sizeof notice)) {}
  close(server_);
  for (const Child& child : children_) close(child.pipe);
}

void ProcessPool::start(Work work, const std::string& bytes, double limit_s, Done done) {
  PALPATE_CHECK(has_room(), "{} jobs are already running", children_.size());
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) fail("cannot create a pipe: {}", std::strerror(errno));
  const std::uint64_t id = next_id_++;
  const std::string folder = std::filesystem::current_path().string();
  const Request request{Request::Kind::kStart, id, work, limit_s, folder.size(), bytes.size()};
  const bool sent = work_server::send_with_file(server_, &request, sizeof request, ends[1]) &&
                    work_server::send_bytes(server_, folder.data(), folder.size()) &&
                    work_server::send_bytes(server_, bytes.data(), bytes.size());
  close(ends[1]);
  fcntl(ends[0], F_SETFL, O_NONBLOCK);
  children_.push_back(
      {id, 0, ends[0], limit_s, 0.0, wall_seconds(), {}, false, false, false, 0, std::move(done)});
  const auto child = std::prev(children_.end());
  while (sent && child->pid == 0 && take_notice()) {}
  if (child->pid > 0) return;
  const bool lost = !sent || child->lost;
  const int why = child->status;
  close(child->pipe);
  children_.erase(child);
  if (lost) fail("cannot start a process: the server of this pool has died");
  if (why != 0) fail("cannot start a process: {}", std::strerror(why));
  fail(
      "the job's function is in a library that was loaded after the helper process had started; load the "
      "library first, then call palpate::ProcessPool::prepare()");
}

bool ProcessPool::take_notice() {
  Notice notice;
  if (!work_server::receive_bytes(server_, &notice, sizeof notice)) {
    for (Child& child : children_) child.lost = child.ended = true;
    return false;
  }
  for (Child& child : children_) {
    if (child.id != notice.id) continue;
    if (notice.kind == Notice::Kind::kStarted) {
      child.pid = notice.value;
    } else if (notice.kind == Notice::Kind::kEnded) {
      child.ended = true;
      child.status = notice.value;
    } else {
      child.pid = -1;
      child.status = notice.value;
    }
  }
  return true;
}

bool ProcessPool::is_asleep(Child& child) {
  clockid_t clock{};
  timespec used{};
  // The process has ended.
  if (clock_getcpuclockid(child.pid, &clock) != 0 || clock_gettime(clock, &used) != 0) return false;
  const double cpu_s = static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
  if (cpu_s > child.cpu_s) child.moved = wall_seconds();
  child.cpu_s = cpu_s;
  return wall_seconds() - child.moved > 3.0 * child.limit_s + 5.0;
}

void ProcessPool::finish(std::list<Child>::iterator at) {
  Child child = std::move(*at);
  children_.erase(at);
  close(child.pipe);
  const int status = child.status;
  Outcome outcome;
  const bool timed_out = child.killed || (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU);
  if (child.lost) {
    outcome = {Outcome::End::kCrash, "lost: the process that started it has died", SIGKILL};
  } else if (timed_out) {
    outcome = {Outcome::End::kOutOfTime, fmt::format("out of time: {:g} s", child.limit_s)};
  } else if (WIFSIGNALED(status)) {
    outcome = {Outcome::End::kCrash,
               fmt::format("killed by signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status))),
               WTERMSIG(status)};
  } else if (WEXITSTATUS(status) != 0 || child.bytes.empty()) {
    outcome = {Outcome::End::kCrash,
               fmt::format("ended with exit status {} and no result", WEXITSTATUS(status))};
  } else {
    const char first = child.bytes[0];
    outcome = {first == work_server::kGood       ? Outcome::End::kDone
               : first == work_server::kNoMemory ? Outcome::End::kNoMemory
                                                 : Outcome::End::kError,
               child.bytes.substr(1)};
  }
  child.done(outcome);
}

void ProcessPool::wait(double most_s) {
  const double end = wall_seconds() + most_s;
  while (!children_.empty()) {
    std::vector<pollfd> polled = {{server_, POLLIN, 0}};
    for (const Child& child : children_) polled.push_back({child.pipe, POLLIN, 0});
    const double left = end - wall_seconds();
    if (poll(polled.data(), polled.size(), static_cast<int>(1e3 * std::clamp(left, 0.0, 0.2))) < 0) {
      if (errno != EINTR) fail("waiting for a run failed: {}", std::strerror(errno));
      for (pollfd& one : polled) one.revents = 0;
    }
    if (polled[0].revents != 0) take_notice();
    bool any = false;
    for (auto child = children_.begin(); child != children_.end();) {
      const auto current = child++;
      // Once a process has ended, all its output is in the pipe.
      char block[1 << 16];
      for (ssize_t n; (n = read(current->pipe, block, sizeof block)) > 0;)
        current->bytes.append(block, static_cast<std::size_t>(n));
      if (current->ended) {
        finish(current);
        any = true;
      } else if (!current->killed && is_asleep(*current)) {
        const Request request{Request::Kind::kKill, current->id, nullptr, 0.0, 0, 0};
        work_server::send_bytes(server_, &request, sizeof request);
        current->killed = true;
      }
    }
    if (any || wall_seconds() >= end) return;
  }
}

}  // namespace palpate
