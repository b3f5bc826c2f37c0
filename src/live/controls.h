#pragma once
#include <atomic>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <string>

namespace palpate::live {

/// Changes that viewers requested since the last look; the newest of each kind counts.
struct Requests {
  bool quit = false, reset = false;
  std::optional<std::string> open;  ///< Name of a scene.
  std::optional<bool> record;
  std::map<std::string, double> values;  ///< By keys of the scene.

  bool any() const { return quit || reset || open || record || !values.empty(); }
};

/// Requests of the server's thread to the thread that runs the scene. A request ends the present run.
class Controls {
 public:
  /// Adds a change, and ends the present run.
  /// @param change  function that changes the pending Requests
  template <class Change>
  void request(const Change& change) {
    const std::lock_guard lock(mutex_);
    change(pending_);
    leave_ = true;
    arrived_.notify_one();
  }
  /// Adds a change that the present run has already taken, for the runs after it.
  template <class Change>
  void note(const Change& change) {
    const std::lock_guard lock(mutex_);
    change(pending_);
  }
  /// Takes all pending requests; a run that starts afterwards is not ended by them.
  Requests take();
  /// Waits for a request, at most `seconds`.
  void wait(double seconds);
  /// Whether the present run is to end.
  const std::atomic<bool>& leave() const { return leave_; }
  std::atomic<bool>& pause() { return pause_; }  ///< Whether the simulation is paused.

 private:
  std::mutex mutex_;
  std::condition_variable arrived_;
  Requests pending_;
  std::atomic<bool> leave_{false}, pause_{false};
};

}  // namespace palpate::live
