#include "browser.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>

namespace palpate::cli {

bool has_display() {
  for (const char* const name : {"DISPLAY", "WAYLAND_DISPLAY"})
    if (const char* value = std::getenv(name); value && *value) return true;
  return false;
}

// The shell ends at once, so that no process of the browser is a child of this one.
bool open_browser(const std::string& url) {
  std::array<std::string, 5> words = {
      "sh", "-c", "command -v xdg-open > /dev/null || exit 1; xdg-open \"$1\" > /dev/null 2>&1 &", "sh", url};
  std::array<char*, 6> arguments{};
  for (std::size_t i = 0; i < words.size(); ++i) arguments[i] = words[i].data();
  pid_t child = 0;
  if (::posix_spawnp(&child, "sh", nullptr, nullptr, arguments.data(), environ) != 0) return false;
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {}
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace palpate::cli
