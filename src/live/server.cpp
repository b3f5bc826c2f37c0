#include "live/server.h"

#include <arpa/inet.h>
#include <libwebsockets.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <thread>

#include "live/access.h"
#include "live/server_impl.h"
#include "palpate/core/error.h"
#include "palpate/core/log.h"

namespace palpate::live {
namespace {

void log_line(int /*level*/, const char* line) {
  std::string text(line);
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  log::debug("libwebsockets: {}", text);
}

/// Checks that the server can listen there, since libwebsockets does not return the reason if it cannot.
/// @throws Error with the reason
void check_listening(const std::string& name, in_addr address, int port) {
  const int probe = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int on = 1;
  if (probe >= 0) ::setsockopt(probe, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  sockaddr_in place{};
  place.sin_family = AF_INET;
  place.sin_addr = address;
  place.sin_port = htons(static_cast<std::uint16_t>(port));
  const bool can_bind = probe >= 0 && ::bind(probe, reinterpret_cast<sockaddr*>(&place), sizeof place) == 0 &&
                        ::listen(probe, 1) == 0;
  const int error = errno;
  if (probe >= 0) ::close(probe);
  if (can_bind) return;
  if (error == EADDRNOTAVAIL)
    fail("--address {}: is no address of this machine; use 127.0.0.1, or an address that `ip address` lists",
         name);
  fail("--port {}: cannot listen on {}:{} ({}); choose another port, or 0 for any free one", port, name, port,
       std::strerror(error));
}

int on_event(lws* wsi, lws_callback_reasons reason, void* /*user*/, void* in, std::size_t length) {
  auto* const server = static_cast<Server::Impl*>(lws_context_user(lws_get_context(wsi)));
  return server ? server->on_event(wsi, static_cast<int>(reason), in, length) : 0;
}

/// Entries for HTTP and for WebSocket, and the end of the list.
const lws_protocols kProtocols[] = {
    {"http", on_event, 0, 2048, 0, nullptr, 0},
    {Server::Impl::kProtocol, on_event, 0, 2048, 0, nullptr, 0},
    {nullptr, nullptr, 0, 0, 0, nullptr, 0},
};

}  // namespace

Server::Impl::Impl(ServerOptions options_in, Controls& controls_in, Broadcast& broadcast_in,
                   const std::atomic<bool>* stop_in)
    : options(std::move(options_in)),
      token(new_token()),
      controls(controls_in),
      broadcast(broadcast_in),
      stop(stop_in),
      viewers(controls_in, names_of(options.scenes), options.limits) {
  in_addr address{};
  if (::inet_pton(AF_INET, options.address.c_str(), &address) != 1)
    fail("--address {}: is not an IPv4 address; use 127.0.0.1 for viewers on this machine only",
         options.address);
  check_listening(options.address, address, options.port);
  loopback = (ntohl(address.s_addr) >> 24) == 127;
  lws_set_log_level(LLL_ERR, log_line);
  lws_context_creation_info info{};
  info.port = options.port;
  info.iface = address.s_addr == INADDR_ANY ? nullptr : options.address.c_str();
  info.protocols = kProtocols;
  info.user = this;
  info.gid = static_cast<decltype(info.gid)>(-1);
  info.uid = static_cast<decltype(info.uid)>(-1);
  info.fd_limit_per_thread = kMostConnections;
  info.timeout_secs = 10;
  static const lws_retry_bo_t validity = {nullptr, 0, 0, 20, 30, 0};  // ping after 20 s, hang up after 30 s
  info.retry_and_idle_policy = &validity;
  info.options = LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND | LWS_SERVER_OPTION_DISABLE_IPV6;
  context.reset(lws_create_context(&info));
  if (!context)
    fail("--port {}: cannot listen on {}:{}; choose another port, or 0 for any free one", options.port,
         options.address, options.port);
  port = lws_get_vhost_listen_port(lws_get_vhost_by_name(context.get(), "default"));
}

void Server::Impl::Destroy::operator()(lws_context* one) const { lws_context_destroy(one); }

std::vector<std::string> Server::Impl::names_of(const std::vector<SceneEntry>& scenes) {
  std::vector<std::string> out;
  for (const SceneEntry& scene : scenes) out.push_back(scene.name);
  return out;
}

Server::Server(ServerOptions options, Controls& controls, Broadcast& broadcast, const std::atomic<bool>* stop)
    : impl_(std::make_unique<Impl>(std::move(options), controls, broadcast, stop)) {
  impl_->thread = std::thread([impl = impl_.get()] { impl->serve(); });
}

Server::~Server() {
  impl_->ending = true;
  lws_cancel_service(impl_->context.get());
  impl_->thread.join();
}

int Server::port() const { return impl_->port; }
std::string Server::token() const { return impl_->token; }
std::string Server::url() const {
  const bool any = impl_->options.address == "0.0.0.0";
  return fmt::format("http://{}:{}/?token={}", any || impl_->loopback ? "127.0.0.1" : impl_->options.address,
                     impl_->port, impl_->token);
}

}  // namespace palpate::live
