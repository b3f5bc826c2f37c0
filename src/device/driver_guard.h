#pragma once
#include <cstdint>
#include <string>

namespace palpate::device {

/// Driver in a shared object, for messages.
struct DriverName {
  std::string text;                    ///< `device driver "NAME" (PATH)`
  std::uintptr_t first = 0, last = 0;  ///< Addresses of the shared object; last is exclusive.
};

/// Handles fatal signals while it exists: a signal inside a driver is reported by one line on standard error
/// that names the driver and its function, and then ends the process as before.
///
/// The driver runs in this process, because a child process costs two context switches per tick, and leaves
/// its motors with the last force all the same if it crashes.
class DriverGuard {
 public:
  /// @param driver  must outlive the guard
  explicit DriverGuard(const DriverName& driver);
  ~DriverGuard();
  DriverGuard(const DriverGuard&) = delete;
  DriverGuard& operator=(const DriverGuard&) = delete;

 private:
  const DriverName& driver_;
};

/// Marks a call of a driver's function on this thread, from construction to destruction.
class DriverCall {
 public:
  /// @param function  name of the function, a literal
  DriverCall(const DriverName& driver, const char* function);
  ~DriverCall();
  DriverCall(const DriverCall&) = delete;
  DriverCall& operator=(const DriverCall&) = delete;
};

}  // namespace palpate::device
