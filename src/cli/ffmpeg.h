#pragma once
#include <sys/types.h>

#include <cstddef>
#include <string>
#include <vector>

namespace palpate::cli {

/// @throws Error with the Debian package where the program is not on the PATH
void check_ffmpeg();

/// The program ffmpeg, reading what is written to it here.  Ctrl-C does not reach it: it ends its file when
/// it has read everything.
class Ffmpeg {
 public:
  /// @param arguments  behind "ffmpeg"; the input is "pipe:0"
  /// @throws Error where it cannot be started
  explicit Ffmpeg(const std::vector<std::string>& arguments);
  ~Ffmpeg();  ///< ends it, whatever it has written
  Ffmpeg(const Ffmpeg&) = delete;
  Ffmpeg& operator=(const Ffmpeg&) = delete;

  /// @throws Error with ffmpeg's own words where it has ended
  void write(const void* bytes, std::size_t count);
  /// Waits until it has made its file.  @throws Error with ffmpeg's own words where it has failed
  void finish();

 private:
  int wait();
  [[noreturn]] void refuse();

  pid_t child_ = 0;
  int input_ = -1, log_ = -1;
};

}  // namespace palpate::cli
