#pragma once
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "live/live_scene.h"

namespace palpate::live {

/// Recording in progress.
struct Recording {
  std::string folder;
  double start_s = 0.0;  ///< Wall clock at its start (core/clock.h).
};

/// State of the session for its viewers.
struct SessionState {
  std::shared_ptr<LiveScene> scene;  ///< null before the first assembly
  std::optional<Recording> recording;
  std::string message;  ///< Activity such as an assembly; empty: none.
  bool running = false;
};

/// Passes the state of the session and texts for all viewers to the server's thread. Only called between
/// runs, never in a tick.
class Broadcast {
 public:
  template <class Change>
  void change(const Change& change_state) {
    const std::lock_guard lock(mutex_);
    change_state(state_);
  }
  /// Sends a message to all viewers.
  void send(std::string text) {
    const std::lock_guard lock(mutex_);
    texts_.push_back(std::move(text));
  }
  /// Returns the state, and removes the texts to be sent.
  std::pair<SessionState, std::vector<std::string>> read() {
    const std::lock_guard lock(mutex_);
    return {state_, std::exchange(texts_, {})};
  }

 private:
  std::mutex mutex_;
  SessionState state_;
  std::vector<std::string> texts_;
};

}  // namespace palpate::live
