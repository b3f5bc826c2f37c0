#pragma once
#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "live/server.h"
#include "palpate/scene/description.h"

namespace palpate::live {

/// Settings of a session.
struct TouchOptions {
  ServerOptions server;
  std::string scene;                   ///< Name or path of the first scene.
  std::vector<std::string> overrides;  ///< Changes of the first scene, as for --set.
  std::string scheme;          ///< Replaces exchange.scheme of every scene; empty: as the scene states.
  std::string folder = "out";  ///< Folder of the recordings' folders.
  /// Loads and checks a scene.  @throws Error for a scene that is not valid
  std::function<scene::Description(const std::string& scene, const std::vector<std::string>& overrides)> load;
  std::function<void(const Server& server)> started;    ///< Called once when the server listens.
  std::function<void(const std::string& line)> report;  ///< Called with events for the terminal.
  const std::atomic<bool>* stop = nullptr;              ///< Set from outside: the session ends.
};

/// Serves the page and runs scenes in real time for its viewers, one after the other as they request, until
/// `stop` is set. Scenes without a hand run in virtual time that keeps pace with the clock.
/// @throws Error for a first scene that cannot be loaded or assembled, and for an address that cannot be used
void run_touch_session(TouchOptions options);

}  // namespace palpate::live
