#pragma once
#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "live/broadcast.h"
#include "live/controls.h"
#include "live/http.h"
#include "live/viewers.h"

namespace palpate::live {

/// Settings of the server.
struct ServerOptions {
  std::string address = "127.0.0.1";  ///< IPv4 address to listen on.
  int port = 0;                       ///< 0: any free port.
  std::vector<SceneEntry> scenes;     ///< Scenes that viewers may open.
  bool in_frames = false;             ///< Whether pages of this machine may show the page in a frame.
  ViewerLimits limits = {};
};

/// Web server of the page, with a thread of its own (libwebsockets). It exchanges data with the simulation
/// through Controls, Broadcast and the buffers of the LiveScene only.
///
/// A viewer gets the newest frame each time its socket can take one: frames that a slow browser misses are
/// not queued, and the system's send buffer is small, so that its picture is never old.
class Server {
 public:
  /// Starts to listen.  @param stop  set from outside: viewers are disconnected, and a `quit` is requested;
  /// may be null
  /// @throws Error if the address or port cannot be used
  Server(ServerOptions options, Controls& controls, Broadcast& broadcast, const std::atomic<bool>* stop);
  /// Tells viewers that the server ends, and ends its thread.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  int port() const;           ///< Port it listens on.
  std::string token() const;  ///< Token of the page's address.
  /// Returns the address of the page with its token, on this machine.
  std::string url() const;

  struct Impl;  ///< Internal; named here for the callback of libwebsockets.

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::live
