#include "work_process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <new>

#include "core/clock.h"
#include "palpate/core/error.h"

namespace palpate::work_server {
namespace {

constexpr double kGraceSeconds = 2.0;

std::atomic<bool> out_of_time{false};
void on_limit(int) { out_of_time = true; }

/// Sets the flag after `limit_s` of CPU time, and a signal that ends the process some time later.
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

/// Separates the process from its server.  Ctrl-C at the terminal stays ignored, as in the server: the caller
/// handles it.  All other signals are reset as in a fresh process.
void detach(pid_t server) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != server) _exit(1);  // The server died before prctl() took effect.
  for (int one : {SIGTERM, SIGHUP, SIGQUIT, SIGCHLD, SIGXCPU, SIGPIPE, SIGSEGV, SIGABRT})
    signal(one, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
}

void send(int fd, const std::string& bytes) {
  for (std::size_t at = 0; at < bytes.size();) {
    const ssize_t n = write(fd, bytes.data() + at, bytes.size() - at);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) _exit(1);
    at += static_cast<std::size_t>(n);
  }
}

}  // namespace

void run_work(Work work, double limit_s, const std::string& folder, const std::string& input, int pipe,
              pid_t server) {
  detach(server);
  limit_cpu(limit_s);
  std::string answer;
  try {
    if (chdir(folder.c_str()) != 0)
      fail("{}: cannot be made the working directory: {}", folder, std::strerror(errno));
    answer = kGood + work(input, out_of_time);
  } catch (const std::bad_alloc&) {
    answer = kNoMemory + std::string("not enough memory");
  } catch (const std::exception& e) { answer = kBad + std::string(e.what()); }
  const itimerval off{};
  setitimer(ITIMER_PROF, &off, nullptr);
  send(pipe, answer);
  _exit(0);  // Destructors of the caller's process must not run here.
}

}  // namespace palpate::work_server
