#include "core/sandbox.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "palpate/core/error.h"

namespace palpate {
namespace {

/// Exit statuses of the child.  Others come from elsewhere: a sanitizer ends a process with 1, for example.
constexpr int kRead = 40, kRefused = 41, kNoMemory = 42;

std::atomic<int> sandbox_disabled{0};

/// CPU limit: 20 s and one second per MiB of the file, about a hundred times the usual cost.
rlim_t longest_s(const std::string& path) {
  constexpr rlim_t kLeast = 20;
  std::error_code none;
  const std::uintmax_t bytes = std::filesystem::file_size(path, none);
  return kLeast + (none ? 0 : static_cast<rlim_t>(bytes >> 20));
}

/// Limits memory to far more than a file of its size needs, so that a wrong number in it cannot exhaust the
/// machine.  Sanitizers reserve terabytes of address space; no limit is set there.
void limit_memory([[maybe_unused]] const std::string& path) {
#ifndef PALPATE_SANITIZED
  constexpr rlim_t kSpare = rlim_t{1} << 30, kTimesTheFile = 64;
  std::error_code none;
  const std::uintmax_t bytes = std::filesystem::file_size(path, none);
  rlim_t pages = 0;
  if (std::ifstream statm("/proc/self/statm"); none || !(statm >> pages)) return;
  const rlim_t most = pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE)) + kTimesTheFile * bytes + kSpare;
  const rlimit memory{most, most};
  ::setrlimit(RLIMIT_AS, &memory);
#endif
}

void write_all(int to, const std::string& text) {
  for (std::size_t at = 0; at < text.size();) {
    const ssize_t n = ::write(to, text.data() + at, text.size() - at);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return;
    at += static_cast<std::size_t>(n);
  }
}

std::string read_all(int from) {
  std::string out;
  char block[4096];
  for (;;) {
    const ssize_t n = ::read(from, block, sizeof block);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return out;
    out.append(block, static_cast<std::size_t>(n));
  }
}

/// Runs the child.  Never returns: destructors of the parent's objects must not run here.
[[noreturn]] void live(int to, const std::string& path, const std::function<void()>& read) {
  ++sandbox_disabled;  // No rehearsal inside the rehearsal.
  if (const int null = ::open("/dev/null", O_WRONLY); null >= 0) ::dup2(null, 1), ::dup2(null, 2);
  const rlimit no_core{0, 0}, time{longest_s(path), longest_s(path)};
  ::setrlimit(RLIMIT_CORE, &no_core);
  ::setrlimit(RLIMIT_CPU, &time);
  limit_memory(path);
  // The alarm also ends a wait for a lock that a thread of the parent held.
  constexpr unsigned kLongestWait = 600;
  // Handlers of the parent, such as one that reports a crash, must not run in the child.
  for (const int signal : {SIGALRM, SIGXCPU, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT})
    std::signal(signal, SIG_DFL);
  ::alarm(kLongestWait);
  int status = kRead;
  try {
    read();
  } catch (const Error& e) {
    write_all(to, e.what());
    status = kRefused;
  } catch (const std::bad_alloc&) { status = kNoMemory; } catch (...) {
    status = 1;
  }
  ::_exit(status);
}

bool ends_endless_work(int signal) { return signal == SIGXCPU || signal == SIGKILL || signal == SIGALRM; }

std::string death(int status) {
  if (WIFSIGNALED(status))
    return ends_endless_work(WTERMSIG(status)) ? "it does not terminate" : ::strsignal(WTERMSIG(status));
  return fmt::format("status {}", WEXITSTATUS(status));
}

}  // namespace

void sandboxed_read(const std::string& path, const char* library, const std::function<void()>& read) {
  if (sandbox_disabled > 0) return;
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) fail("{}: cannot create a pipe: {}", path, std::strerror(errno));
  const pid_t child = ::fork();
  if (child < 0) {
    const std::string why = std::strerror(errno);
    ::close(ends[0]), ::close(ends[1]);
    fail("{}: cannot start a process to read it: {}", path, why);
  }
  if (child == 0) live(ends[1], path, read);
  ::close(ends[1]);
  const std::string message = read_all(ends[0]);
  ::close(ends[0]);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {}
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  if (code == kRead) return;
  if (code == kRefused && !message.empty()) throw Error(message);
  if (code == kNoMemory)
    fail("{}: reading it takes more memory than is available; it is damaged or too large", path);
  fail("{}: is damaged: {} fails while reading it ({}); copy it again, or recreate it", path, library,
       death(status));
}

NoSandbox::NoSandbox() { ++sandbox_disabled; }
NoSandbox::~NoSandbox() { --sandbox_disabled; }

}  // namespace palpate
