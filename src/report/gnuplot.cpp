#include "gnuplot.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "core/program.h"
#include "palpate/core/error.h"

extern char** environ;

namespace palpate::report {
namespace {

namespace fs = std::filesystem;

class TemporaryDirectory {
 public:
  TemporaryDirectory() {
    std::string name = (fs::path(temporary_folder()) / "palpate-plot-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
      fail("{}: no temporary directory could be made ({}); set TMPDIR to a folder that can be written", name,
           std::strerror(errno));
    path_ = name;
  }
  ~TemporaryDirectory() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

std::string text_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Runs `gnuplot -d plot.gp` (-d: the ~/.gnuplot of the user must not change the figures) with its output in
/// `log`; returns the exit status.
int spawn_gnuplot(const fs::path& dir, const fs::path& log) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, dir.c_str());
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_adddup2(&actions, 1, 2);
  std::string program = "gnuplot", option = "-d", script = "plot.gp";
  char* arguments[] = {program.data(), option.data(), script.data(), nullptr};
  pid_t child = 0;
  const int error = posix_spawnp(&child, program.c_str(), &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error == ENOENT) fail("gnuplot was not found: it draws the plots; install the package gnuplot-nox");
  if (error != 0) fail("gnuplot could not be started: {}", std::strerror(error));
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {}
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

std::string run_gnuplot(const std::string& script) {
  const TemporaryDirectory dir;
  std::ofstream(dir.path() / "plot.gp", std::ios::binary) << script;
  const int status = spawn_gnuplot(dir.path(), dir.path() / "log");
  const std::string svg = text_of(dir.path() / "plot.svg");
  // gnuplot exits with 0 after some failures (a full disk), so the end of the document is checked too.
  if (status != 0 || svg.find("</svg>") == std::string::npos)
    fail("gnuplot drew no plot (exit status {}): {}", status, text_of(dir.path() / "log"));
  return svg;
}

}  // namespace palpate::report
