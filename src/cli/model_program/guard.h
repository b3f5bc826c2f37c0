#pragma once
#include <string>

namespace palpate::cli {

/// Ends the program at once, whatever it is doing, also in steps that cannot be interrupted: on Ctrl-C and
/// SIGTERM (status 130, one line).  What is written meanwhile must be whole or absent: see SignalsHeld.
void catch_stop();

/// Ends it in the same way, with a refusal (status 1), when `seconds` from now are over.
void catch_time(double seconds);

/// What the refusal says when the time is over.
void set_refusal(const std::string& text);

/// Signals wait while this lives: around the writing of the model's file.  Its making is over: the time that
/// catch_time() watches no longer counts.
class SignalsHeld {
 public:
  SignalsHeld();
  void written();  ///< a signal from now on ends the program with other words: the file is there
  ~SignalsHeld();
  SignalsHeld(const SignalsHeld&) = delete;
  SignalsHeld& operator=(const SignalsHeld&) = delete;
};

}  // namespace palpate::cli
