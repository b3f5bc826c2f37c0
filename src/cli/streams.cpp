#include "cli/streams.h"

#include <fcntl.h>
#include <sys/types.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>

#include "core/printable.h"

namespace palpate::cli {
namespace {

int failure = 0;  ///< errno of the first failed write to standard output; 0: none

void write_all(int to, const std::string& text) {
  for (std::size_t at = 0; at < text.size();) {
    const ssize_t n = ::write(to, text.data() + at, text.size() - at);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && to == STDOUT_FILENO && failure == 0) failure = errno;
    if (n <= 0) return;
    at += static_cast<std::size_t>(n);
  }
}

/// Write function of a stream; reports success even if writing fails.
ssize_t write_printable(void* cookie, const char* bytes, std::size_t size) {
  write_all(static_cast<int>(reinterpret_cast<std::intptr_t>(cookie)), printable({bytes, size}));
  return static_cast<ssize_t>(size);
}

std::FILE* guarded_stream(int to, int buffering) {
  cookie_io_functions_t functions = {};
  functions.write = write_printable;
  std::FILE* stream = ::fopencookie(reinterpret_cast<void*>(static_cast<std::intptr_t>(to)), "w", functions);
  if (stream) std::setvbuf(stream, nullptr, buffering, BUFSIZ);
  return stream;
}

}  // namespace

void guard_streams() {
  for (const int standard : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(standard, F_GETFD) < 0 && errno == EBADF)
      if (const int null = ::open("/dev/null", O_RDWR); null != standard && null >= 0) ::close(null);
  const int buffering = ::isatty(STDOUT_FILENO) == 1 ? _IOLBF : _IOFBF;
  if (std::FILE* out = guarded_stream(STDOUT_FILENO, buffering)) stdout = out;
  if (std::FILE* err = guarded_stream(STDERR_FILENO, _IONBF)) stderr = err;
}

std::string output_failure() {
  std::fflush(stdout);
  std::fflush(stderr);
  return failure == 0 ? "" : std::strerror(failure);
}

}  // namespace palpate::cli
