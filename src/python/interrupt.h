#pragma once
#include <csignal>

#include <atomic>

namespace palpate::python {

/// While it lives, Ctrl-C sets a flag, and tells Python that its own handler is due.  Python's handler alone
/// would run only after the call into C++ has returned.
class Interrupt {
 public:
  /// @param stop  set to true by SIGINT
  /// @param wanted  false in a thread that gets no signals, where this does nothing
  Interrupt(std::atomic<bool>& stop, bool wanted);
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

 private:
  bool installed_ = false;
  struct sigaction before_ = {};
};

/// Whether this thread is Python's main one.  @pre the GIL is held
bool is_main_thread();
/// Runs Python's handlers that are due; throws what they raise (KeyboardInterrupt).  @pre the GIL is held
void run_due_handlers();

}  // namespace palpate::python
