#include "cli/other_program.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "core/program.h"
#include "palpate/core/error.h"

namespace palpate::cli {
namespace fs = std::filesystem;
namespace {

fs::path place_of(const OtherProgram& other) {
  return fs::path(program_path()).parent_path() / other.program;
}

/// Returns pointers to the words, which must outlive them, and a null pointer: argv of a program.
std::vector<char*> arguments_of(std::vector<std::string>& words) {
  std::vector<char*> out;
  for (std::string& word : words) out.push_back(word.data());
  out.push_back(nullptr);
  return out;
}

[[noreturn]] void refuse(const OtherProgram& other, int error) {
  fail("{}: {} cannot be started: {}", other.command, place_of(other).string(), std::strerror(error));
}

/// Reads the pipe until its other end is closed.
std::string read_all(int from) {
  std::string out;
  std::array<char, 4096> some{};
  while (true) {
    const ssize_t n = ::read(from, some.data(), some.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return out;
    out.append(some.data(), static_cast<std::size_t>(n));
  }
}

}  // namespace

const OtherProgram* find_other_program(std::string_view command) {
  for (const OtherProgram* other : {&kModel, &kTouch, &kBench, &kValidate})
    if (other->command == command) return other;
  return nullptr;
}

bool is_there(const OtherProgram& other) { return fs::exists(place_of(other)); }

std::string path_of(const OtherProgram& other) {
  const std::string program = place_of(other).string();
  if (!is_there(other)) fail("{}: {} does not exist: {}", other.command, program, other.absent);
  return program;
}

int start(const OtherProgram& other, std::vector<std::string> words) {
  const std::string program = path_of(other);
  std::string name = "palpate";
  if (!other.has_commands) {
    words.erase(std::find(words.begin(), words.end(), other.command));
    name += fmt::format(" {}", other.command);
  }
  words.insert(words.begin(), name);
  ::execv(program.c_str(), arguments_of(words).data());
  refuse(other, errno);
}

std::string output_of(const OtherProgram& other) {
  std::vector<std::string> words = {path_of(other), std::string(other.command)};
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) refuse(other, errno);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  for (const int end : ends) posix_spawn_file_actions_addclose(&actions, end);
  pid_t child = 0;
  const int error =
      posix_spawn(&child, words.front().c_str(), &actions, nullptr, arguments_of(words).data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  std::string out;
  if (error == 0) out = read_all(ends[0]);
  ::close(ends[0]);
  if (error != 0) refuse(other, error);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {}
  if (status != 0) fail("{} {} failed; see above", words[0], words[1]);
  return out;
}

int run_silently(const OtherProgram& other, const std::vector<std::string>& words,
                 const std::string& folder) {
  std::vector<std::string> all = {std::filesystem::absolute(path_of(other)).string()};
  all.insert(all.end(), words.begin(), words.end());
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  if (!folder.empty()) posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  pid_t child = 0;
  const int error =
      posix_spawn(&child, all.front().c_str(), &actions, nullptr, arguments_of(all).data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) refuse(other, error);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {}
  return status;
}

}  // namespace palpate::cli
