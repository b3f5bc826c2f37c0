#include "input_end.h"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <csignal>

namespace palpate::cli {
namespace {

void watch(const std::stop_token& stop) {
  constexpr int kPatience = 100;  // [ms]
  std::array<char, 256> dropped{};
  while (!stop.stop_requested()) {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (::poll(&input, 1, kPatience) <= 0) continue;
    if (::read(STDIN_FILENO, dropped.data(), dropped.size()) > 0) continue;
    ::kill(::getpid(), SIGTERM);
    return;
  }
}

}  // namespace

InputEnd::InputEnd() : watcher_(watch) {}

}  // namespace palpate::cli
