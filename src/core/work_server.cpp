#include "work_server.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <map>
#include <mutex>

#include "palpate/core/error.h"
#include "socket_message.h"

namespace palpate::work_server {
namespace {

#ifdef __SANITIZE_THREAD__
constexpr long kThreadsOfOurOwn = 2;  // The sanitizer runs one that is safe to fork.
#else
constexpr long kThreadsOfOurOwn = 1;
#endif

/// Waits for children and parent alike: SIGCHLD arrives when a child has ended and, by request, when the
/// parent has.
class FamilySignals {
 public:
  explicit FamilySignals(pid_t parent) : parent_(parent) {
    sigemptyset(&set_);
    sigaddset(&set_, SIGCHLD);
    signal(SIGCHLD, SIG_DFL);
    sigprocmask(SIG_SETMASK, &set_, nullptr);
    file_ = signalfd(-1, &set_, SFD_CLOEXEC | SFD_NONBLOCK);
    prctl(PR_SET_PDEATHSIG, SIGCHLD);
  }
  int file() const { return file_; }
  /// Whether the parent process is gone.  Linux sends the signal already when the parent's thread that forked
  /// ends; the process may still live.
  bool parent_died() const { return getppid() != parent_; }
  void drain() const {
    signalfd_siginfo info;
    while (read(file_, &info, sizeof info) > 0) {}
  }

 private:
  pid_t parent_;
  int file_ = -1;
  sigset_t set_{};
};

/// Returns true where the socket has data (or its other side is gone), false on a signal.
bool wait_for_request(int socket, const FamilySignals& family) {
  pollfd polled[] = {{socket, POLLIN, 0}, {family.file(), POLLIN, 0}};
  while (!family.parent_died()) {
    if (poll(polled, 2, -1) < 0 && errno == EINTR) continue;
    if (polled[1].revents != 0) {
      family.drain();
      return false;
    }
    if (polled[0].revents != 0) return true;
  }
  return false;
}

/// Ignores Ctrl-C and other signals meant for the caller, and discards the output of libraries, which must
/// not mix into printed tables.
void leave_terminal() {
  for (int one : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE}) signal(one, SIG_IGN);
  const int nowhere = open("/dev/null", O_RDWR);
  for (int fd : {0, 1, 2}) dup2(nowhere, fd);
  if (nowhere > 2) close(nowhere);
}

// --- server of a pool

class Server {
 public:
  Server(int socket, pid_t helper) : socket_(socket), family_(helper) {}

  [[noreturn]] void run() {
    while (!family_.parent_died()) {
      if (wait_for_request(socket_, family_)) {
        if (!serve()) break;
      } else {
        reap();
      }
    }
    for (const auto& [pid, id] : running_) kill(pid, SIGKILL);
    while (waitpid(-1, nullptr, 0) > 0 || errno == EINTR) {}
    _exit(0);
  }

 private:
  bool say(Notice::Kind kind, std::uint64_t id, int value) {
    const Notice notice{kind, id, value};
    return send_bytes(socket_, &notice, sizeof notice);
  }

  bool serve() {
    Request request;
    int pipe = -1;
    if (!receive_with_file(socket_, &request, sizeof request, pipe)) return false;
    if (request.kind == Request::Kind::kKill) {
      for (const auto& [pid, id] : running_)
        if (id == request.id) kill(pid, SIGKILL);
      return true;
    }
    std::string folder(request.folder_size, '\0'), input(request.input_size, '\0');
    const bool whole = receive_bytes(socket_, folder.data(), folder.size()) &&
                       receive_bytes(socket_, input.data(), input.size()) &&
                       start(request, folder, input, pipe);
    close(pipe);
    return whole;
  }

  bool start(const Request& request, const std::string& folder, const std::string& input, int pipe) {
    // Code that was loaded after the helper was made does not exist in this process.
    Dl_info found;
    if (dladdr(reinterpret_cast<const void*>(request.work), &found) == 0)
      return say(Notice::Kind::kNotStarted, request.id, 0);
    const pid_t self = getpid(), pid = fork();
    if (pid < 0) return say(Notice::Kind::kNotStarted, request.id, errno);
    if (pid == 0) {
      close(socket_);
      close(family_.file());
      run_work(request.work, request.limit_s, folder, input, pipe, self);
    }
    running_[pid] = request.id;
    return say(Notice::Kind::kStarted, request.id, pid);
  }

  void reap() {
    int status = 0;
    for (pid_t pid; (pid = waitpid(-1, &status, WNOHANG)) > 0;) {
      const auto at = running_.find(pid);
      if (at == running_.end()) continue;
      say(Notice::Kind::kEnded, at->second, status);
      running_.erase(at);
    }
  }

  int socket_;
  FamilySignals family_;
  std::map<pid_t, std::uint64_t> running_;
};

// --- helper

[[noreturn]] void run_helper(int socket, pid_t caller) {
  leave_terminal();
  const FamilySignals family(caller);
  const pid_t self = getpid();
  while (!family.parent_died()) {
    if (!wait_for_request(socket, family)) {
      while (waitpid(-1, nullptr, WNOHANG) > 0) {}
      continue;
    }
    char byte;
    int client = -1;
    if (!receive_with_file(socket, &byte, 1, client)) break;
    if (fork() == 0) {
      close(socket);
      close(family.file());
      Server(client, self).run();
    }
    close(client);  // Without a server the pool finds its socket closed.
  }
  _exit(0);  // The servers detect it and end.
}

// --- caller's side

/// Helper of this process.  After a fork, `owner` differs from getpid() until the process has created a
/// helper.
struct Helper {
  std::mutex mutex;
  pid_t owner = 0;
  int socket = -1;
};
Helper& helper() {
  static Helper one;
  return one;
}

long thread_count() {
  std::error_code none;
  const std::filesystem::directory_iterator begin("/proc/self/task", none), end;
  return none ? 1 : static_cast<long>(std::distance(begin, end));
}

/// Makes two connected sockets.
void make_pair(int (&ends)[2]) {
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    fail("cannot create a socket: {}", std::strerror(errno));
}

void make_helper(Helper& own) {
  if (own.socket >= 0) close(own.socket);  // Belongs to the process that this one was forked from.
  own.socket = -1;
  int ends[2];
  make_pair(ends);
  const pid_t caller = getpid(), pid = fork();
  if (pid < 0) {
    const int why = errno;
    for (const int end : ends) close(end);
    fail("cannot start a process: {}", std::strerror(why));
  }
  if (pid == 0) {
    close(ends[0]);
    own.mutex.unlock();  // Work may use a pool, and then makes another helper.
    run_helper(ends[1], caller);
  }
  close(ends[1]);
  // Counted after the fork: a library with fork handlers (OpenBLAS) stops its threads before it.
  if (const long threads = thread_count(); threads > kThreadsOfOurOwn) {
    close(ends[0]);
    while (waitpid(pid, nullptr, 0) < 0 && errno == EINTR) {}
    fail(
        "runs in separate processes can no longer be started: this process has {} threads, and a fork of it "
        "would inherit their locks but not the threads; call palpate::ProcessPool::prepare() at the start of "
        "main(), before anything starts a thread or opens a picture",
        threads);
  }
  own.owner = caller;
  own.socket = ends[0];
}

}  // namespace

void prepare() {
  Helper& own = helper();
  const std::lock_guard lock(own.mutex);
  if (own.owner != getpid()) make_helper(own);
}

int connect() {
  prepare();
  Helper& own = helper();
  const std::lock_guard lock(own.mutex);
  int ends[2];
  make_pair(ends);
  const char byte = 'p';
  const bool sent = send_with_file(own.socket, &byte, 1, ends[1]);
  close(ends[1]);
  if (sent) return ends[0];
  close(ends[0]);
  own.owner = 0;  // The next pool tries to make another.
  fail("the helper process that starts the runs has died");
}

}  // namespace palpate::work_server
