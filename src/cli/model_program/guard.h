#pragma once
#include <string>

namespace palpate::cli {

/// Installs handlers that end the program at once on Ctrl-C and SIGTERM (status 130, one line), also in steps
/// that cannot be interrupted. Files written meanwhile must be complete or absent: see SignalsHeld.
void catch_stop();

/// Installs a timer that ends the program with an error message (status 1) after `seconds`.
void catch_time(double seconds);

/// Sets the error message of the timer.
void set_refusal(const std::string& text);

/// Guard that blocks these signals during the writing of the model file. The computation is then over: the
/// timer of catch_time() is disarmed.
class SignalsHeld {
 public:
  SignalsHeld();
  void written();  ///< Changes the message of a later signal: the file exists
  ~SignalsHeld();
  SignalsHeld(const SignalsHeld&) = delete;
  SignalsHeld& operator=(const SignalsHeld&) = delete;
};

}  // namespace palpate::cli
