#include "experiments/slurm.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <regex>

#include "experiments/indices.h"
#include "palpate/core/error.h"

extern char** environ;

namespace palpate::experiments {
namespace {

constexpr std::size_t kDefaultArraySize = 1001;
constexpr const char* kPackage = "slurm-client";  // Debian package with sbatch, squeue and scontrol.

/// Returns the opening quote and a path for an #SBATCH line, where % begins a field.
std::string sbatch_path(const std::string& path) {
  std::string out = "\"";
  for (const char c : path) out += c == '%' ? std::string("%%") : std::string(1, c);
  return out;
}

/// Returns the name of a job: one word.
std::string job_name(const std::string& name) {
  std::string out = "palpate-";
  for (const char c : name) out += std::isalnum(static_cast<unsigned char>(c)) ? c : '-';
  return out;
}

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

/// Reads two pipes until both are closed.
void read_both(int out_end, int err_end, Answer& answer) {
  pollfd polled[] = {{out_end, POLLIN, 0}, {err_end, POLLIN, 0}};
  std::string* texts[] = {&answer.out, &answer.err};
  for (int open = 2; open > 0;) {
    if (poll(polled, 2, -1) < 0 && errno != EINTR) break;
    for (int i = 0; i < 2; ++i) {
      if (polled[i].fd < 0 || polled[i].revents == 0) continue;
      char block[4096];
      const ssize_t n = read(polled[i].fd, block, sizeof block);
      if (n > 0) texts[i]->append(block, static_cast<std::size_t>(n));
      if (n == 0) polled[i].fd = -1, --open;
    }
  }
}

std::string trimmed(const std::string& text) {
  const std::size_t last = text.find_last_not_of(" \t\r\n");
  return last == std::string::npos ? "" : text.substr(0, last + 1);
}

}  // namespace

std::vector<std::string> elements_of(const std::vector<std::vector<std::size_t>>& groups, std::size_t chunk,
                                     std::size_t most) {
  const std::size_t needed = (groups.size() + most - 1) / most;
  const std::size_t each = std::max({chunk, needed, std::size_t{1}});
  std::vector<std::string> out;
  for (std::size_t i = 0; i < groups.size(); i += each) {
    std::vector<std::size_t> tasks;
    for (std::size_t k = i; k < std::min(i + each, groups.size()); ++k)
      tasks.insert(tasks.end(), groups[k].begin(), groups[k].end());
    std::sort(tasks.begin(), tasks.end());
    out.push_back(text_of(tasks));
  }
  return out;
}

std::string quoted(const std::string& word) {
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string sbatch_script(const ArrayJob& job) {
  std::string out = fmt::format(
      "#!/bin/bash\n"
      "# Made by `palpate {} --slurm`: element k of the array runs tasks[k] of {}.\n"
      "#SBATCH --job-name={}\n#SBATCH --array=0-{}\n#SBATCH --cpus-per-task={}\n"
      "#SBATCH --output={}/slurm/%A_%a.log\"\n",
      job.command, one_line(job.subject), job_name(job.name), job.elements.size() - 1, job.threads,
      sbatch_path(job.folder));
  if (!job.options.empty()) out += fmt::format("#SBATCH {}\n", one_line(job.options));
  out += "tasks=(\n";
  for (const std::string& element : job.elements) out += "  " + element + "\n";
  std::string arguments;
  for (const std::string& word : job.words) arguments += " " + quoted(word);
  out += fmt::format(")\nexec {} {}{} -o {} --jobs 1 --plan {} --task \"${{tasks[$SLURM_ARRAY_TASK_ID]}}\"\n",
                     quoted(job.program), job.command, arguments, quoted(job.folder), job.key);
  return out;
}

Answer ask(const std::vector<std::string>& words) {
  int out_pipe[2], err_pipe[2];
  if (pipe2(out_pipe, O_CLOEXEC) != 0 || pipe2(err_pipe, O_CLOEXEC) != 0)
    fail("cannot create a pipe: {}", std::strerror(errno));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, out_pipe[1], 1);
  posix_spawn_file_actions_adddup2(&actions, err_pipe[1], 2);
  std::vector<std::string> own = words;
  std::vector<char*> arguments;
  for (std::string& word : own) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t child = 0;
  const int error = posix_spawnp(&child, own[0].c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(out_pipe[1]);
  close(err_pipe[1]);
  Answer answer;
  if (error == 0) read_both(out_pipe[0], err_pipe[0], answer);
  close(out_pipe[0]);
  close(err_pipe[0]);
  if (error == ENOENT)
    fail("{} was not found: it belongs to Slurm; install the package {}, or run without --slurm", words[0],
         kPackage);
  if (error != 0) fail("{} could not be started: {}", words[0], std::strerror(error));
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {}
  answer.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return answer;
}

std::size_t max_array_size() {
  const Answer answer = ask({"scontrol", "show", "config"});
  std::smatch found;
  if (answer.status != 0 || !std::regex_search(answer.out, found, std::regex("MaxArraySize\\s*=\\s*(\\d+)")))
    return kDefaultArraySize;
  return std::max<std::size_t>(1, std::stoul(found[1]));
}

std::string submit(const std::string& script) {
  const Answer answer = ask({"sbatch", "--parsable", script});
  if (answer.status != 0)
    fail("sbatch rejected {} (exit status {}):\n{}", script, answer.status, trimmed(answer.err + answer.out));
  const std::string job = trimmed(answer.out);
  return job.substr(0, job.find(';'));  // Output may be "7;cluster".
}

JobState job_state(const std::string& job) {
  const Answer answer = ask({"squeue", "--noheader", "--jobs", job, "--format", "%T"});
  if (answer.status == 0) return trimmed(answer.out).empty() ? JobState::kOver : JobState::kWaiting;
  // Slurm deletes a job from its records some minutes after its end.
  if (answer.err.find("Invalid job id") != std::string::npos) return JobState::kOver;
  return JobState::kUnknown;
}

}  // namespace palpate::experiments
