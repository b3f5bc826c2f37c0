#pragma once
#include <atomic>
#include <functional>
#include <string>

namespace palpate::session {

/// Connection of a long operation to its caller. Each member may be empty.
struct Callbacks {
  std::function<void(double fraction)> progress;  ///< Called with the completed share, in [0, 1]
  /// Called with a description of the event if a run has to wait for a device
  std::function<void(const std::string& awaited)> waiting;
  const std::atomic<bool>* stop =
      nullptr;  ///< Set from outside: the operation ends early, its files complete

  void report(double fraction) const {
    if (progress) progress(fraction);
  }
  bool stopped() const { return stop && stop->load(); }
};

}  // namespace palpate::session
