#pragma once
#include <string>

namespace palpate::cli {

/// Progress line on standard error with the completed share and the remaining time: `assembling [#####-----]
/// 50 %  12 s left`. It appears after the first second, is rewritten at most ten times per second and is
/// erased at the end. If standard error is no terminal, a line is written every ten seconds instead.
class Progress {
 public:
  explicit Progress(std::string what);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Updates the line.
  /// @param fraction  completed share, in [0, 1]
  /// @param text      current activity; empty: the name given to the constructor
  void operator()(double fraction, const std::string& text = {});
  void wipe();  ///< Erases the line

 private:
  std::string what_;
  bool terminal_;
  bool shown_ = false;
  double start_, last_ = 0.0;
};

/// Returns the line for a pipe or a log: "palpate: replaying out/run: 34 %, 2 min 10 s left".
/// @param fraction  completed share, in [0, 1]
/// @param elapsed_s  time since the start [s]
std::string progress_line(double fraction, double elapsed_s, const std::string& what);

/// Returns a duration as text: "3 s", "2 min 10 s", "1 h 5 min".
std::string duration_text(double seconds);

}  // namespace palpate::cli
