#include "browser.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>

#include "core/program.h"

namespace palpate::cli {

bool has_display() {
  for (const char* const name : {"DISPLAY", "WAYLAND_DISPLAY"})
    if (const char* value = std::getenv(name); value && *value) return true;
  return false;
}

ForwardingPage::~ForwardingPage() {
  if (!path_.empty()) ::unlink(path_.c_str());
}

// The shell ends at once, so that no process of the browser is a child of this one.
bool ForwardingPage::open(const std::string& url) {
  std::string path = temporary_folder() + "/palpate-touch-XXXXXX.html";
  const int file = ::mkstemps(path.data(), 5);  // readable by this user only
  if (file < 0) return false;
  path_ = path;
  const std::string text =
      "<!doctype html><meta charset=\"utf-8\"><meta http-equiv=\"refresh\" content=\"0; url=" + url +
      "\"><title>palpate touch</title>\n";
  const bool written = ::write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  ::close(file);
  if (!written) return false;
  std::array<std::string, 5> words = {
      "sh", "-c", "command -v xdg-open > /dev/null || exit 1; xdg-open \"$1\" > /dev/null 2>&1 &", "sh",
      path};
  std::array<char*, 6> arguments{};
  for (std::size_t i = 0; i < words.size(); ++i) arguments[i] = words[i].data();
  pid_t child = 0;
  if (::posix_spawnp(&child, "sh", nullptr, nullptr, arguments.data(), environ) != 0) return false;
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {}
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace palpate::cli
