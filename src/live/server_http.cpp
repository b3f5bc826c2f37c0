#include <libwebsockets.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "live/access.h"
#include "live/server_impl.h"

namespace palpate::live {
namespace {

std::string header(lws* wsi, lws_token_indexes index) {
  std::array<char, 512> text{};
  const int length = lws_hdr_copy(wsi, text.data(), static_cast<int>(text.size()), index);
  return length > 0 ? std::string(text.data(), static_cast<std::size_t>(length)) : std::string();
}

/// Sends a status with a short body instead of what was requested. Returns libwebsockets' code for a refused
/// upgrade.
int refuse(lws* wsi, unsigned status) {
  lws_return_http_status(wsi, status, nullptr);
  return 1;
}

}  // namespace

bool Server::Impl::has_token(lws* wsi) const {
  constexpr std::string_view kName = "token=";
  std::array<char, 128> argument{};
  for (int i = 0; lws_hdr_copy_fragment(wsi, argument.data(), static_cast<int>(argument.size()),
                                        WSI_TOKEN_HTTP_URI_ARGS, i) > 0;
       ++i) {
    const std::string_view text(argument.data());
    if (text.starts_with(kName)) return is_equal(text.substr(kName.size()), token);
  }
  return false;
}

bool Server::Impl::is_own_host(lws* wsi) const {
  return live::is_own_host(header(wsi, WSI_TOKEN_HOST), loopback);
}

int Server::Impl::confirm_upgrade(lws* wsi, std::string_view kind) {
  const std::string path = header(wsi, WSI_TOKEN_GET_URI);
  if (kind != "websocket" || path != "/socket") return refuse(wsi, HTTP_STATUS_NOT_FOUND);
  if (!has_token(wsi) || !is_own_host(wsi) ||
      !is_own_origin(header(wsi, WSI_TOKEN_ORIGIN), header(wsi, WSI_TOKEN_HOST)) ||
      header(wsi, WSI_TOKEN_PROTOCOL) != kProtocol)
    return refuse(wsi, HTTP_STATUS_FORBIDDEN);
  if (viewers.is_full()) return refuse(wsi, HTTP_STATUS_SERVICE_UNAVAILABLE);
  return 0;
}

int Server::Impl::begin_reply(lws* wsi, std::string_view path) {
  Transfer& transfer = transfers[wsi];
  transfer = {};
  if (lws_hdr_total_length(wsi, WSI_TOKEN_GET_URI) == 0)
    transfer.reply = {405, "text/plain; charset=utf-8", "Only GET is supported.\n"};
  else if (!is_own_host(wsi))
    transfer.reply = {403, "text/plain; charset=utf-8", "This server does not have that name.\n"};
  else
    transfer.reply = reply_to(path, has_token(wsi), token, options.scenes);
  std::array<unsigned char, LWS_PRE + 2048> head{};
  unsigned char *const start = head.data() + LWS_PRE, *at = start, *const end = head.data() + head.size() - 1;
  const HttpReply& reply = transfer.reply;
  if (lws_add_http_common_headers(wsi, reply.status, reply.type, reply.content().size(), &at, end)) return 1;
  for (const HttpHeader& one : http_headers(options.in_frames))
    if (lws_add_http_header_by_name(wsi, reinterpret_cast<const unsigned char*>(one.name),
                                    reinterpret_cast<const unsigned char*>(one.value.c_str()),
                                    static_cast<int>(one.value.size()), &at, end))
      return 1;
  if (lws_finalize_write_http_header(wsi, start, &at, end)) return 1;
  lws_callback_on_writable(wsi);
  return 0;
}

int Server::Impl::continue_reply(lws* wsi) {
  constexpr std::size_t kPart = 32 << 10;
  const auto found = transfers.find(wsi);
  if (found == transfers.end()) return -1;
  Transfer& transfer = found->second;
  const std::string_view content = transfer.reply.content();
  const std::size_t part = std::min(kPart, content.size() - transfer.sent);
  const bool last = transfer.sent + part == content.size();
  padded.resize(LWS_PRE + part);
  std::memcpy(padded.data() + LWS_PRE, content.data() + transfer.sent, part);
  const int written =
      lws_write(wsi, padded.data() + LWS_PRE, part, last ? LWS_WRITE_HTTP_FINAL : LWS_WRITE_HTTP);
  if (written < static_cast<int>(part)) return -1;
  transfer.sent += part;
  if (!last) {
    lws_callback_on_writable(wsi);
    return 0;
  }
  transfers.erase(found);
  return lws_http_transaction_completed(wsi) ? -1 : 0;
}

}  // namespace palpate::live
