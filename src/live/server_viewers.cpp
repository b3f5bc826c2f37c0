#include <libwebsockets.h>
#include <sys/socket.h>

#include <algorithm>
#include <cstring>

#include "core/clock.h"
#include "live/server_impl.h"

namespace palpate::live {

int Server::Impl::on_event(lws* wsi, int reason, void* in, std::size_t length) {
  const auto text = [&] { return std::string_view(static_cast<const char*>(in), length); };
  switch (reason) {
    case LWS_CALLBACK_HTTP_CONFIRM_UPGRADE:
      return confirm_upgrade(wsi, in ? std::string_view(static_cast<const char*>(in)) : std::string_view());
    case LWS_CALLBACK_HTTP: return begin_reply(wsi, text());
    case LWS_CALLBACK_HTTP_WRITEABLE: return continue_reply(wsi);
    case LWS_CALLBACK_CLOSED_HTTP: transfers.erase(wsi); return 0;
    case LWS_CALLBACK_ESTABLISHED: open(wsi); return 0;
    case LWS_CALLBACK_RECEIVE: return receive(wsi, text());
    case LWS_CALLBACK_SERVER_WRITEABLE: return write(wsi);
    case LWS_CALLBACK_CLOSED: close(wsi); return 0;
    default: return 0;
  }
}

namespace {

/// Timer of the server's thread.
struct Timer {
  lws_sorted_usec_list_t list{};
  Server::Impl* server = nullptr;
};

// The callback schedules itself: lws_service() does not return after a timer, but waits for the next one.
void on_timer(lws_sorted_usec_list_t* list) {
  Timer* const timer = lws_container_of(list, Timer, list);
  const double seconds = timer->server->turn();
  lws_sul_schedule(timer->server->context.get(), 0, list, on_timer, static_cast<lws_usec_t>(1e6 * seconds));
}

}  // namespace

double Server::Impl::turn() {
  look();
  if (stop && *stop && !std::exchange(quit_requested, true))
    controls.request([](Requests& r) { r.quit = true; });
  return connections.empty() ? kIdleTurn : kTurn;
}

void Server::Impl::serve() {
  Timer timer;
  timer.server = this;
  lws_sul_schedule(context.get(), 0, &timer.list, on_timer, 1);
  while (!ending) lws_service(context.get(), 0);
  closing = true;
  for (auto& [wsi, connection] : connections) lws_callback_on_writable(wsi);
  for (const double deadline = wall_seconds() + 0.5; !connections.empty() && wall_seconds() < deadline;)
    lws_service(context.get(), 0);
  lws_sul_cancel(&timer.list);
}

void Server::Impl::open(lws* wsi) {
  // A small buffer holds little that is old; frames are made when the socket can take one.
  constexpr int kSendBuffer = 128 << 10;
  ::setsockopt(lws_get_socket_fd(wsi), SOL_SOCKET, SO_SNDBUF, &kSendBuffer, sizeof kSendBuffer);
  Connection& connection = connections[wsi];
  connection.viewer = viewers.add();
  connection.scene_due = connection.geometry_due = session.scene != nullptr;
  connection.frame_due = has_frame;
  connection.next_row = strip.end();
  if (session.scene) session.scene->watched = true;
  send_state_to_all();
}

void Server::Impl::close(lws* wsi) {
  const auto found = connections.find(wsi);
  if (found == connections.end()) return;
  viewers.remove(found->second.viewer);
  connections.erase(found);
  if (session.scene) session.scene->watched = !connections.empty();
  send_state_to_all();
}

int Server::Impl::receive(lws* wsi, std::string_view part) {
  const auto found = connections.find(wsi);
  if (found == connections.end()) return -1;
  Connection& connection = found->second;
  if (lws_frame_is_binary(wsi) || connection.received.size() + part.size() > kLongestMessage)
    connection.too_long = true;
  else
    connection.received += part;
  if (!lws_is_final_fragment(wsi)) return 0;
  const std::string message = std::exchange(connection.received, {});
  std::optional<std::string_view> text;
  if (!std::exchange(connection.too_long, false)) text = message;
  const std::string holder = viewers.place_of(connection.viewer).holder;
  const bool paused = controls.pause();
  const Viewers::Reply reply = viewers.receive(connection.viewer, text, wall_seconds());
  if (reply.close) {
    lws_close_reason(wsi, LWS_CLOSE_STATUS_POLICY_VIOLATION, nullptr, 0);
    return -1;
  }
  if (!reply.notice.empty()) queue(wsi, connection, std::make_shared<const std::string>(reply.notice));
  if (holder != viewers.place_of(connection.viewer).holder || paused != controls.pause()) send_state_to_all();
  return 0;
}

void Server::Impl::queue(lws* wsi, Connection& connection, const std::shared_ptr<const std::string>& text) {
  if (connection.texts.size() >= kMostTexts) connection.texts.pop_front();
  connection.texts.push_back(text);
  lws_callback_on_writable(wsi);
}

void Server::Impl::send_state_to_all() {
  for (auto& [wsi, connection] : connections) {
    connection.state_due = true;
    lws_callback_on_writable(wsi);
  }
}

void Server::Impl::look() {
  const bool was_running = session.running, was_recording = session.recording.has_value();
  const std::string said = session.message;
  const std::shared_ptr<LiveScene> shown = session.scene;
  auto [now, texts] = broadcast.read();
  session = std::move(now);
  if (session.scene != shown) {
    viewers.show(session.scene);
    strip = {};
    status = {};
    has_frame = false;
    for (auto& [wsi, connection] : connections) {
      connection.scene_due = connection.geometry_due = true;
      connection.frame_due = false;
      connection.next_row = 0;
      lws_callback_on_writable(wsi);
    }
    if (session.scene) session.scene->watched = !connections.empty();
  }
  for (std::string& text : texts) {
    const auto shared = std::make_shared<const std::string>(std::move(text));
    for (auto& [wsi, connection] : connections) queue(wsi, connection, shared);
  }
  if (session.scene) {
    status = session.scene->status.latest();
    strip.read(session.scene->strip);
    if (session.scene->frames.take()) {
      has_frame = true;
      for (auto& [wsi, connection] : connections) {
        connection.frame_due = true;
        lws_callback_on_writable(wsi);
      }
    }
  }
  const double wall = wall_seconds();
  const bool changed = was_running != session.running || was_recording != session.recording.has_value() ||
                       said != session.message;
  if (!changed && wall < next_state_s) return;
  next_state_s = wall + kStatePeriod;
  send_state_to_all();
}

int Server::Impl::write(lws* wsi) {
  const auto found = connections.find(wsi);
  if (found == connections.end()) return -1;
  Connection& c = found->second;
  if (closing) {
    lws_close_reason(wsi, LWS_CLOSE_STATUS_GOINGAWAY, nullptr, 0);
    return -1;
  }
  if (c.scene_due && session.scene) {
    c.scene_due = false;
    const std::string& text = session.scene->description;
    return send(wsi, text.data(), text.size(), false);
  }
  if (c.geometry_due && session.scene) {
    c.geometry_due = false;
    const Bytes& bytes = session.scene->geometry;
    return send(wsi, bytes.data(), bytes.size(), true);
  }
  if (!c.texts.empty()) {
    const std::shared_ptr<const std::string> text = c.texts.front();
    c.texts.pop_front();
    return send(wsi, text->data(), text->size(), false);
  }
  if (c.state_due) {
    c.state_due = false;
    const std::string text =
        state_text(status, session, controls.pause(), viewers.place_of(c.viewer), wall_seconds());
    return send(wsi, text.data(), text.size(), false);
  }
  if (c.frame_due && session.scene) {
    c.frame_due = false;
    write_frame(session.scene->frames.front(), strip, session.scene->hands, c.next_row, buffer);
    return send(wsi, buffer.data(), buffer.size(), true);
  }
  return 0;
}

/// Sends a whole message. What the socket does not take at once, libwebsockets keeps; it then asks for no
/// further message until that is sent.
int Server::Impl::send(lws* wsi, const void* data, std::size_t size, bool binary) {
  padded.resize(LWS_PRE + size);
  std::memcpy(padded.data() + LWS_PRE, data, size);
  if (lws_write(wsi, padded.data() + LWS_PRE, size, binary ? LWS_WRITE_BINARY : LWS_WRITE_TEXT) <
      static_cast<int>(size))
    return -1;
  lws_callback_on_writable(wsi);
  return 0;
}

}  // namespace palpate::live
