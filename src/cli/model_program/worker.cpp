#include "worker.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "palpate/core/error.h"

namespace palpate::cli {
namespace {

/// Memory shared between the child and its parent.
struct Notes {
  char stage[128], place[256];
};
Notes* notes = nullptr;
volatile pid_t child = 0;

void put(char* to, std::size_t size, const std::string& text) {
  const std::size_t length = std::min(text.size(), size - 1);
  std::memcpy(to, text.data(), length);
  to[length] = '\0';
}

void pass_on(int signal) {
  if (child > 0) ::kill(child, signal);
}

/// Creates a folder, enters it and removes it: no file can then be created by a relative name.
void enter_no_folder() {
  const char* const requested = std::getenv("TMPDIR");
  for (const char* parent : {requested ? requested : "/tmp", "/tmp", "/var/tmp", "/dev/shm"}) {
    std::string folder = std::string(parent) + "/palpate-model-XXXXXX";
    if (!::mkdtemp(folder.data())) continue;
    const bool entered = ::chdir(folder.c_str()) == 0;
    ::rmdir(folder.c_str());
    if (entered) return;
  }
}

/// Disables the stage in which a child ended; returns false if that stage cannot be disabled.
bool leave_out(const WorkerEnd& end, model::Optimisation& optimisation) {
  const bool moving = end.stage == model::kMovingVertices, exuding = end.stage == model::kExudingSlivers;
  if (!moving && !exuding) return false;
  (moving ? optimisation.why_not_moved : optimisation.why_not_exuded) = end.signal;
  return std::exchange(moving ? optimisation.move_vertices : optimisation.exude_slivers, false);
}

[[noreturn]] void live(const std::function<int()>& work, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(1);  // the parent ended before prctl()
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  enter_no_folder();
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) std::signal(signal, SIG_DFL);
  const int status = work();
  std::fflush(nullptr);
  ::_exit(status);
}

}  // namespace

void worker_stage(const std::string& stage) {
  if (!notes) return;
  put(notes->stage, sizeof notes->stage, stage);
  put(notes->place, sizeof notes->place, "");
}

void worker_place(const std::string& place) {
  if (notes) put(notes->place, sizeof notes->place, place);
}

WorkerEnd run_worker(const std::function<int()>& work) {
  if (!notes) {
    void* const shared =
        ::mmap(nullptr, sizeof(Notes), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (shared == MAP_FAILED) fail("no memory can be shared with a process: {}", std::strerror(errno));
    notes = static_cast<Notes*>(shared);
  }
  *notes = {};
  std::fflush(nullptr);  // buffered output would be written twice
  struct sigaction action = {};
  action.sa_handler = pass_on;
  for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
  const pid_t parent = ::getpid(), started = ::fork();
  if (started < 0) fail("the process that makes the model cannot be started: {}", std::strerror(errno));
  if (started == 0) live(work, parent);
  child = started;
  int status = 0;
  while (::waitpid(started, &status, 0) < 0 && errno == EINTR) {}
  child = 0;
  WorkerEnd out;
  out.stage = notes->stage;
  out.place = notes->place;
  if (WIFSIGNALED(status))
    out.signal = ::strsignal(WTERMSIG(status));
  else
    out.status = WEXITSTATUS(status);
  return out;
}

WorkerEnd run_attempts(model::Optimisation optimisation,
                       const std::function<int(const model::Optimisation&)>& work) {
  for (;;) {
    WorkerEnd end = run_worker([&] { return work(optimisation); });
    if (end.signal.empty() || !leave_out(end, optimisation)) return end;
  }
}

}  // namespace palpate::cli
