#pragma once
#include <sys/types.h>

#include <cstddef>
#include <string>
#include <vector>

namespace palpate::session {

/// Checks that ffmpeg is on the PATH, and that it has an encoder.
/// @param encoder  name of the encoder, as in `ffmpeg -encoders`; empty: not checked
/// @throws Error with the name of the Debian package if there is no ffmpeg, or with the encoder if it is
/// missing
void check_ffmpeg(const std::string& encoder = {});

/// Child process ffmpeg that reads the bytes written here. Ctrl-C does not reach it: it completes its file
/// when its input ends.
class Ffmpeg {
 public:
  /// Starts ffmpeg.
  /// @param arguments  arguments after "ffmpeg"; the input is "pipe:0"
  /// @throws Error if it cannot be started
  explicit Ffmpeg(const std::vector<std::string>& arguments);
  ~Ffmpeg();  ///< Ends the process, even if its file is incomplete
  Ffmpeg(const Ffmpeg&) = delete;
  Ffmpeg& operator=(const Ffmpeg&) = delete;

  /// Sends bytes to ffmpeg.
  /// @throws Error with the message of ffmpeg if it has ended
  void write(const void* bytes, std::size_t count);
  /// Closes the input and waits until ffmpeg has completed its file.
  /// @throws Error with the message of ffmpeg if it failed
  void finish();
  /// Returns the output of ffmpeg so far, its last 64 KiB.
  std::string output() const;

 private:
  int wait();
  [[noreturn]] void refuse();

  pid_t child_ = 0;
  int input_ = -1, log_ = -1;
};

}  // namespace palpate::session
