#pragma once
#include <atomic>
#include <cstddef>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "live/frame_message.h"
#include "live/server.h"

struct lws;
struct lws_context;

namespace palpate::live {

/// State of the server, which its thread alone uses after construction.
struct Server::Impl {
  static constexpr const char* kProtocol = "palpate-touch-1";
  static constexpr int kMostConnections = 64;    ///< With those of libwebsockets itself.
  static constexpr std::size_t kMostTexts = 32;  ///< Texts that wait for one viewer.
  static constexpr double kTurn = 1.0 / 60.0;    ///< Time between two looks at the simulation [s].
  static constexpr double kIdleTurn = 0.1;       ///< The same while nobody watches [s].
  static constexpr double kStatePeriod = 0.1;    ///< Time between two messages `state` [s].

  /// Connection of a viewer.
  struct Connection {
    int viewer = 0;
    std::string received;                                  ///< Parts of a message so far.
    bool too_long = false;                                 ///< The message is too long, or no text.
    std::deque<std::shared_ptr<const std::string>> texts;  ///< To be sent, oldest first.
    bool scene_due = false, geometry_due = false, state_due = false, frame_due = false;
    std::uint64_t next_row = 0;
  };
  /// Reply on its way to a browser.
  struct Transfer {
    HttpReply reply;
    std::size_t sent = 0;
  };
  struct Destroy {
    void operator()(lws_context* one) const;
  };

  Impl(ServerOptions options, Controls& controls, Broadcast& broadcast, const std::atomic<bool>* stop);
  static std::vector<std::string> names_of(const std::vector<SceneEntry>& scenes);

  /// Body of the thread.
  void serve();
  /// Looks at the simulation and at `stop`. Returns the time to the next turn [s].
  double turn();
  int on_event(lws* wsi, int reason, void* in, std::size_t length);

  // HTTP (server_http.cpp)
  bool has_token(lws* wsi) const;
  bool is_own_host(lws* wsi) const;
  /// Decides on a request for a WebSocket. Returns 0 to accept it, else libwebsockets' code.
  int confirm_upgrade(lws* wsi, std::string_view protocol);
  int begin_reply(lws* wsi, std::string_view path);
  int continue_reply(lws* wsi);

  // Viewers (server_viewers.cpp)
  void open(lws* wsi);
  void close(lws* wsi);
  int receive(lws* wsi, std::string_view part);
  int write(lws* wsi);
  void look();  ///< Reads the state of the simulation, and makes messages due.
  void send_state_to_all();
  void queue(lws* wsi, Connection& connection, const std::shared_ptr<const std::string>& text);
  int send(lws* wsi, const void* data, std::size_t size, bool binary);

  ServerOptions options;
  std::string token;
  Controls& controls;
  Broadcast& broadcast;
  const std::atomic<bool>* stop;
  Viewers viewers;
  bool loopback = true;
  int port = 0;
  std::unique_ptr<lws_context, Destroy> context;
  std::thread thread;
  std::atomic<bool> ending{false};
  bool closing = false;  ///< Viewers are being disconnected.
  bool quit_requested = false;
  std::map<lws*, Connection> connections;
  std::map<lws*, Transfer> transfers;
  SessionState session;
  LiveStatus status;
  StripHistory strip;
  bool has_frame = false;
  double next_state_s = 0.0;
  Bytes buffer;                       ///< Message being made.
  std::vector<unsigned char> padded;  ///< The same, behind the space that libwebsockets needs.
};

}  // namespace palpate::live
