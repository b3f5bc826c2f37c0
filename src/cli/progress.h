#pragma once
#include <string>

namespace palpate::cli {

/// One line on standard error that shows how far something is and how long it still takes: `assembling
/// [#####-----]  50 %  12 s left`. It appears after the first second, is rewritten at most ten times a
/// second, is wiped at the end, and stays silent where standard error is no terminal.
class Progress {
 public:
  explicit Progress(std::string what);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// @param fraction  done, in [0, 1]  @param text  what is being done now; empty: the name given at the
  ///   start
  void operator()(double fraction, const std::string& text = {});
  void wipe();

 private:
  std::string what_;
  bool terminal_;
  bool shown_ = false;
  double start_, last_ = 0.0;
};

/// "3 s", "2 min 10 s", "1 h 5 min".
std::string duration_text(double seconds);

}  // namespace palpate::cli
