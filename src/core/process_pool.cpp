#include "palpate/core/process_pool.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "palpate/core/clock.h"
#include "palpate/core/error.h"

namespace palpate {
namespace {

constexpr char kGood = 'g', kBad = 'b';  ///< first byte of what a child sends
constexpr double kGraceSeconds = 2.0;

std::atomic<bool> out_of_time{false};
void on_limit(int) { out_of_time = true; }

/// The flag after `limit_s` of CPU time; a signal that ends the process some time after.
void limit_cpu(double limit_s) {
  struct sigaction action = {};
  action.sa_handler = on_limit;
  action.sa_flags = SA_RESTART;
  sigaction(SIGPROF, &action, nullptr);
  const double whole = std::floor(limit_s);
  const itimerval timer{
      {0, 0}, {static_cast<time_t>(whole), static_cast<suseconds_t>(std::max(1.0, 1e6 * (limit_s - whole)))}};
  setitimer(ITIMER_PROF, &timer, nullptr);
  const auto last = static_cast<rlim_t>(std::ceil(cpu_seconds() + limit_s + kGraceSeconds));
  const rlimit seconds{last, last + 5}, none{0, 0};
  setrlimit(RLIMIT_CPU, &seconds);
  setrlimit(RLIMIT_CORE, &none);
}

/// The terminal's Ctrl-C is the parent's to heed; what libraries print belongs to no table.
void detach(pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);  // it died before that
  signal(SIGINT, SIG_IGN);
  for (int one : {SIGTERM, SIGXCPU, SIGPIPE, SIGSEGV, SIGABRT}) signal(one, SIG_DFL);
  const int nowhere = open("/dev/null", O_RDWR);
  for (int fd : {0, 1, 2}) dup2(nowhere, fd);
}

void send(int fd, const std::string& bytes) {
  for (std::size_t at = 0; at < bytes.size();) {
    const ssize_t n = write(fd, bytes.data() + at, bytes.size() - at);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) _exit(1);
    at += static_cast<std::size_t>(n);
  }
}

[[noreturn]] void run_child(const ProcessPool::Work& work, double limit_s, pid_t parent, int fd) {
  detach(parent);
  limit_cpu(limit_s);
  std::string answer;
  try {
    answer = kGood + work(out_of_time);
  } catch (const std::exception& e) { answer = kBad + std::string(e.what()); }
  const itimerval off{};
  setitimer(ITIMER_PROF, &off, nullptr);
  send(fd, answer);
  _exit(0);  // no destructor of the parent's runs here
}

}  // namespace

ProcessPool::ProcessPool(int jobs) : jobs_(std::max(1, jobs)) {}

ProcessPool::~ProcessPool() {
  for (const Child& child : children_) kill(child.pid, SIGKILL);
  for (const Child& child : children_) {
    while (waitpid(child.pid, nullptr, 0) < 0 && errno == EINTR) {}
    close(child.pipe);
  }
}

void ProcessPool::start(Work work, double limit_s, Done done) {
  PALPATE_CHECK(has_room(), "{} pieces of work run already", children_.size());
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) fail("no pipe can be made: {}", std::strerror(errno));
  const pid_t parent = getpid(), pid = fork();
  if (pid < 0) fail("no process can be started: {}", std::strerror(errno));
  if (pid == 0) {
    close(ends[0]);
    for (const Child& other : children_) close(other.pipe);
    run_child(work, limit_s, parent, ends[1]);
  }
  close(ends[1]);
  fcntl(ends[0], F_SETFL, O_NONBLOCK);
  children_.push_back({pid, ends[0], limit_s, 0.0, wall_seconds(), {}, false, std::move(done)});
}

bool ProcessPool::is_asleep(Child& child) {
  clockid_t clock{};
  timespec used{};
  // it has ended
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
  int status = 0;
  while (waitpid(child.pid, &status, 0) < 0 && errno == EINTR) {}
  Outcome outcome;
  const bool late = child.killed || (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU);
  if (late) {
    outcome = {Outcome::End::kOutOfTime, fmt::format("out of time: {:g} s", child.limit_s)};
  } else if (WIFSIGNALED(status)) {
    outcome = {Outcome::End::kCrash,
               fmt::format("killed by signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)))};
  } else if (WEXITSTATUS(status) != 0 || child.bytes.empty()) {
    outcome = {Outcome::End::kCrash,
               fmt::format("ended with exit status {} and no result", WEXITSTATUS(status))};
  } else {
    outcome = {child.bytes[0] == kGood ? Outcome::End::kDone : Outcome::End::kError, child.bytes.substr(1)};
  }
  child.done(outcome);
}

void ProcessPool::wait(double most_s) {
  const double end = wall_seconds() + most_s;
  while (!children_.empty()) {
    std::vector<pollfd> polled;
    for (const Child& child : children_) polled.push_back({child.pipe, POLLIN, 0});
    const double left = end - wall_seconds();
    if (poll(polled.data(), polled.size(), static_cast<int>(1e3 * std::clamp(left, 0.0, 0.2))) < 0 &&
        errno != EINTR)
      fail("waiting for a run failed: {}", std::strerror(errno));
    bool any = false;
    for (auto child = children_.begin(); child != children_.end();) {
      const auto current = child++;
      char block[1 << 16];
      ssize_t n;
      while ((n = read(current->pipe, block, sizeof block)) > 0)
        current->bytes.append(block, static_cast<std::size_t>(n));
      if (n == 0) {
        finish(current);
        any = true;
      } else if (!current->killed && is_asleep(*current)) {
        kill(current->pid, SIGKILL);
        current->killed = true;
      }
    }
    if (any || wall_seconds() >= end) return;
  }
}

}  // namespace palpate
