#include "interrupt.h"

#include <pybind11/pybind11.h>

namespace py = pybind11;

namespace palpate::python {
namespace {

std::atomic<std::atomic<bool>*> flag{nullptr};
static_assert(std::atomic<std::atomic<bool>*>::is_always_lock_free && std::atomic<bool>::is_always_lock_free,
              "a signal handler may touch only lock-free atomics");

void on_interrupt(int signal) {
  if (std::atomic<bool>* stop = flag.load()) *stop = true;
  PyErr_SetInterruptEx(signal);
}

}  // namespace

Interrupt::Interrupt(std::atomic<bool>& stop, bool requested) {
  if (!requested || flag.load()) return;
  sigaction(SIGINT, nullptr, &before_);
  if (before_.sa_handler == SIG_IGN) return;
  flag = &stop;
  struct sigaction own = {};
  own.sa_handler = on_interrupt;
  sigemptyset(&own.sa_mask);
  sigaction(SIGINT, &own, nullptr);
  installed_ = true;
}

Interrupt::~Interrupt() {
  if (!installed_) return;
  sigaction(SIGINT, &before_, nullptr);
  flag = nullptr;
}

bool is_main_thread() {
  const py::module_ threading = py::module_::import("threading");
  return threading.attr("current_thread")().is(threading.attr("main_thread")());
}

void run_due_handlers() {
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

}  // namespace palpate::python
