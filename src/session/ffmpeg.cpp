#include "session/ffmpeg.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "palpate/core/error.h"

extern char** environ;

namespace palpate::session {
namespace {

constexpr const char* kProgram = "ffmpeg";

[[noreturn]] void fail_not_found() {
  fail(
      "ffmpeg was not found, and .mp4 and .webm movies require it; install the package ffmpeg, or give a "
      "file name "
      "that ends in .png");
}

/// Returns the end of the log of ffmpeg.
std::string read_log(int log) {
  std::string text(1 << 16, '\0');
  const off_t size = lseek(log, 0, SEEK_END);
  const auto kept = static_cast<off_t>(text.size());
  const ssize_t count = pread(log, text.data(), text.size(), size > kept ? size - kept : 0);
  text.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
  return text;
}

/// Returns the last line of a log, which states the error.
std::string last_line(int log) {
  std::string text = read_log(log);
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  const std::size_t begin = text.find_last_of("\r\n");
  if (begin != std::string::npos) text.erase(0, begin + 1);
  return text.empty() ? "no message" : text;
}

}  // namespace

namespace {

void find_ffmpeg() {
  const char* variable = std::getenv("PATH");
  const std::string path = variable ? variable : "";
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find(':', begin), path.size());
    const std::filesystem::path program = std::filesystem::path(path.substr(begin, end - begin)) / kProgram;
    if (std::filesystem::is_regular_file(program) && access(program.c_str(), X_OK) == 0) return;
    begin = end + 1;
  }
  fail_not_found();
}

}  // namespace

void check_ffmpeg(const std::string& encoder) {
  find_ffmpeg();
  if (encoder.empty()) return;
  Ffmpeg list({"-hide_banner", "-encoders"});
  list.finish();
  if (list.output().find(" " + encoder + " ") == std::string::npos)
    fail(
        "this ffmpeg has no encoder {} (`ffmpeg -encoders`), which .mp4 movies require; install Debian's "
        "package "
        "ffmpeg, or give a file name that ends in .webm or .png",
        encoder);
}

// A socket, not a pipe: with MSG_NOSIGNAL, writing to an ffmpeg that has ended is an error, not a signal.
Ffmpeg::Ffmpeg(const std::vector<std::string>& arguments) {
  int ends[2] = {-1, -1};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    fail("ffmpeg could not be started: {}", std::strerror(errno));
  input_ = ends[0];
  log_ = memfd_create("ffmpeg", MFD_CLOEXEC);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], 0);
  posix_spawn_file_actions_adddup2(&actions, log_, 1);
  posix_spawn_file_actions_adddup2(&actions, log_, 2);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes,
                           POSIX_SPAWN_SETPGROUP);  // shields it from Ctrl-C
  std::vector<std::string> words = {kProgram};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const int error = posix_spawnp(&child_, kProgram, &actions, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  if (error == 0) return;
  child_ = 0;
  close(input_);
  if (log_ >= 0) close(log_);
  if (error == ENOENT) fail_not_found();
  fail("ffmpeg could not be started: {}", std::strerror(error));
}

Ffmpeg::~Ffmpeg() {
  if (child_ > 0) {
    kill(child_, SIGKILL);
    wait();
  }
  if (log_ >= 0) close(log_);
}

int Ffmpeg::wait() {
  if (input_ >= 0) close(input_);
  input_ = -1;
  int status = 0;
  while (waitpid(child_, &status, 0) < 0 && errno == EINTR) {}
  child_ = 0;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

void Ffmpeg::refuse() {
  const int status = wait();
  fail("ffmpeg failed (exit status {}): {}", status, last_line(log_));
}

void Ffmpeg::write(const void* bytes, std::size_t count) {
  for (const char* at = static_cast<const char*>(bytes); count > 0;) {
    const ssize_t sent = send(input_, at, count, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) refuse();
    at += sent;
    count -= static_cast<std::size_t>(sent);
  }
}

std::string Ffmpeg::output() const { return read_log(log_); }

void Ffmpeg::finish() {
  const int status = wait();
  if (status != 0) fail("ffmpeg failed (exit status {}): {}", status, last_line(log_));
}

}  // namespace palpate::session
