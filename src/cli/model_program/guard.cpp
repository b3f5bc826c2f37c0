#include "guard.h"

#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstring>

#include "cli/stop.h"

namespace palpate::cli {
namespace {

constexpr std::size_t kLongest = 2048;
/// Two buffers, so that the handler never reads one that is being changed.
std::array<std::array<char, kLongest>, 2> refusals{};
std::atomic<unsigned> current{0};
std::atomic<const char*> stopped{"palpate: stopped, no model was written\n"};
std::atomic<bool> on_terminal{false};
static_assert(std::atomic<unsigned>::is_always_lock_free && std::atomic<const char*>::is_always_lock_free,
              "a signal handler may touch only lock-free atomics");

/// Writes a message from a signal handler, in which only write and _exit and few other calls are allowed.
void say(const char* text) {
  const auto put = [](const char* words) {
    [[maybe_unused]] const ssize_t ignored = ::write(STDERR_FILENO, words, std::strlen(words));
  };
  if (on_terminal) put("\r\033[K");  // erases the progress line
  put(text);
}

void on_stop(int) {
  say(stopped);
  ::_exit(kExitStopped);
}

void on_time(int) {
  say(refusals[current].data());
  ::_exit(kExitError);
}

sigset_t guarded_signals() {
  sigset_t out;
  sigemptyset(&out);
  for (const int signal : {SIGINT, SIGTERM, SIGALRM}) sigaddset(&out, signal);
  return out;
}

}  // namespace

void catch_stop() {
  on_terminal = ::isatty(STDERR_FILENO) == 1;
  struct sigaction action = {};
  action.sa_mask = guarded_signals();
  action.sa_handler = on_stop;
  for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
}

void catch_time(double seconds) {
  struct sigaction action = {};
  action.sa_mask = guarded_signals();
  action.sa_handler = on_time;
  sigaction(SIGALRM, &action, nullptr);
  constexpr double kLongest = 1e8;
  const double bounded = std::min(seconds, kLongest), whole = std::floor(bounded);
  itimerval timer = {};
  timer.it_value.tv_sec = static_cast<time_t>(whole);
  // a value of zero would disarm the timer
  timer.it_value.tv_usec = std::max<suseconds_t>(static_cast<suseconds_t>(1e6 * (bounded - whole)), 1);
  setitimer(ITIMER_REAL, &timer, nullptr);
}

void set_refusal(const std::string& text) {
  const unsigned next = 1 - current;
  const std::size_t length = std::min(text.size(), kLongest - 2);
  std::copy_n(text.begin(), length, refusals[next].begin());
  refusals[next][length] = '\n';
  refusals[next][length + 1] = '\0';
  current = next;
}

SignalsHeld::SignalsHeld() {
  const itimerval none = {};
  setitimer(ITIMER_REAL, &none, nullptr);
  const sigset_t all = guarded_signals();
  sigprocmask(SIG_BLOCK, &all, nullptr);
}

void SignalsHeld::written() { stopped = "palpate: stopped; the model is complete\n"; }

SignalsHeld::~SignalsHeld() {
  const sigset_t all = guarded_signals();
  sigprocmask(SIG_UNBLOCK, &all, nullptr);
}

}  // namespace palpate::cli
