#include "driver_guard.h"

#include <signal.h>
#include <ucontext.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <mutex>

#include "palpate/core/error.h"

namespace palpate::device {
namespace {

struct FatalSignal {
  int number;
  const char* name;
  struct sigaction before;
};
std::array<FatalSignal, 5> fatal_signals = {{{SIGSEGV, "SIGSEGV", {}},
                                             {SIGBUS, "SIGBUS", {}},
                                             {SIGFPE, "SIGFPE", {}},
                                             {SIGILL, "SIGILL", {}},
                                             {SIGABRT, "SIGABRT", {}}}};

// Present call of this thread, and the loaded drivers. The handler only reads them: it may not lock.
thread_local const DriverName* called_driver = nullptr;
thread_local const char* called_function = nullptr;
constexpr std::size_t kMostDrivers = 32;
std::array<std::atomic<const DriverName*>, kMostDrivers> drivers{};
std::mutex guards;
int guard_count = 0;

/// Returns the address of the instruction that raised a signal; 0 where it is not known.
std::uintptr_t instruction_of(const void* context) {
  const auto* const state = static_cast<const ucontext_t*>(context);
#if defined(__x86_64__)
  return static_cast<std::uintptr_t>(state->uc_mcontext.gregs[REG_RIP]);
#elif defined(__aarch64__)
  return static_cast<std::uintptr_t>(state->uc_mcontext.pc);
#else
  return state ? 0 : 0;
#endif
}

void print(const char* text) {
  const ssize_t written = ::write(STDERR_FILENO, text, std::strlen(text));
  (void)written;  // there is nobody to report it to
}

void on_fatal_signal(int number, siginfo_t*, void* context) {
  const auto found = std::find_if(fatal_signals.begin(), fatal_signals.end(),
                                  [number](const FatalSignal& one) { return one.number == number; });
  const DriverName* driver = called_driver;
  const char* place = called_function;
  const std::uintptr_t at = instruction_of(context);
  for (const auto& one : drivers) {
    const DriverName* const other = one.load();
    if (!driver && other && at >= other->first && at < other->last) driver = other, place = "its own thread";
  }
  if (driver) {
    print("palpate: error: "), print(driver->text.c_str()), print(": "), print(found->name);
    print(" in "), print(place);
    print("; the process ends, and the device no longer receives forces; correct the driver\n");
  }
  ::sigaction(number, &found->before, nullptr);
  ::raise(number);  // blocked until this handler returns
}

}  // namespace

DriverGuard::DriverGuard(const DriverName& driver) : driver_(driver) {
  const std::scoped_lock lock(guards);
  const auto slot = std::find_if(drivers.begin(), drivers.end(), [](const auto& one) { return !one.load(); });
  if (slot == drivers.end()) fail("device: more than {} drivers are loaded", kMostDrivers);
  *slot = &driver;
  if (guard_count++ > 0) return;
  for (FatalSignal& one : fatal_signals) {
    struct sigaction own = {};
    own.sa_sigaction = on_fatal_signal;
    own.sa_flags = SA_SIGINFO | SA_ONSTACK;
    sigemptyset(&own.sa_mask);
    ::sigaction(one.number, &own, &one.before);
  }
}

DriverGuard::~DriverGuard() {
  const std::scoped_lock lock(guards);
  for (auto& one : drivers)
    if (one.load() == &driver_) one = nullptr;
  if (--guard_count > 0) return;
  for (const FatalSignal& one : fatal_signals) ::sigaction(one.number, &one.before, nullptr);
}

DriverCall::DriverCall(const DriverName& driver, const char* function) {
  called_driver = &driver;
  called_function = function;
}

DriverCall::~DriverCall() {
  called_driver = nullptr;
  called_function = nullptr;
}

}  // namespace palpate::device
