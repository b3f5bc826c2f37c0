#include "cli/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "core/clock.h"
#include "core/printable.h"

namespace palpate::cli {
namespace {

constexpr double kQuietSeconds = 1.0, kBetweenSeconds = 0.1;
constexpr double kPipeSeconds = 10.0;    // Between two lines where standard error is no terminal.
constexpr double kLeastFraction = 0.02;  // Below it the remaining time is not estimated.
constexpr std::size_t kBarWidth = 24;

int terminal_width() {
  winsize size{};
  return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

/// Writes to standard error past the stream guard (streams.h), since a progress bar consists of control
/// characters.
void draw(const std::string& text) {
  std::fflush(stderr);
  std::size_t at = 0;
  while (at < text.size()) {
    const ssize_t n = ::write(STDERR_FILENO, text.data() + at, text.size() - at);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return;
    at += static_cast<std::size_t>(n);
  }
}

constexpr const char* kWipe = "\r\033[K";

}  // namespace

std::string progress_line(double fraction, double elapsed_s, const std::string& what) {
  std::string out = fmt::format("palpate: {}: {:.0f} %", printable(what), 100.0 * fraction);
  if (fraction > kLeastFraction && fraction < 1.0)
    out += fmt::format(", {} left", duration_text(elapsed_s * (1.0 - fraction) / fraction));
  return out;
}

std::string duration_text(double seconds) {
  const long s = std::lround(std::clamp(seconds, 0.0, 1e9));
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {} s", s / 60, s % 60);
  return fmt::format("{} h {} min", s / 3600, s % 3600 / 60);
}

Progress::Progress(std::string what)
    : what_(std::move(what)), terminal_(::isatty(STDERR_FILENO) == 1), start_(wall_seconds()) {
  if (const char* term = std::getenv("TERM"); term && std::string(term) == "dumb") terminal_ = false;
}

Progress::~Progress() { wipe(); }

void Progress::operator()(double fraction, const std::string& text) {
  const double now = wall_seconds();
  fraction = std::clamp(fraction, 0.0, 1.0);
  if (!terminal_) {
    if (now - std::max(start_, last_) < kPipeSeconds) return;
    last_ = now;
    fmt::print(stderr, "{}\n", progress_line(fraction, now - start_, text.empty() ? what_ : text));
    return;
  }
  if (now - start_ < kQuietSeconds || now - last_ < kBetweenSeconds) return;
  last_ = now;
  const auto filled = static_cast<std::size_t>(fraction * static_cast<double>(kBarWidth));
  std::string line = fmt::format("[{}{}] {:3.0f} %", std::string(filled, '#'),
                                 std::string(kBarWidth - filled, '-'), 100.0 * fraction);
  if (fraction > kLeastFraction)
    line += fmt::format("  {} left", duration_text((now - start_) * (1.0 - fraction) / fraction));
  line += "  " + printable(text.empty() ? what_ : text);
  line.resize(std::min<std::size_t>(line.size(), static_cast<std::size_t>(terminal_width() - 1)));
  draw(kWipe + line);
  shown_ = true;
}

void Progress::wipe() {
  if (!shown_) return;
  draw(kWipe);
  shown_ = false;
}

}  // namespace palpate::cli
