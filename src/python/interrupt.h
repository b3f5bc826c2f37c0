#pragma once
#include <csignal>

#include <atomic>

namespace palpate::python {

/// Scope in which Ctrl-C sets a flag and marks Python's handler as pending.  Python's handler alone would run
/// only after the call into C++ has returned.
class Interrupt {
 public:
  /// Installs the handler of SIGINT.
  /// @param stop  set to true by SIGINT
  /// @param requested  false in a thread that receives no signals; the object then has no effect
  Interrupt(std::atomic<bool>& stop, bool requested);
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

 private:
  bool installed_ = false;
  struct sigaction before_ = {};
};

/// Whether this thread is Python's main thread.  @pre the GIL is held
bool is_main_thread();
/// Runs pending Python handlers; throws the exception that they raise (KeyboardInterrupt).  @pre the GIL is
/// held
void run_due_handlers();

}  // namespace palpate::python
