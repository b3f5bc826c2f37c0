#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace palpate::live {

/// Scene that viewers may open.
struct SceneEntry {
  std::string name, summary;
  std::string picture;  ///< File of a picture (PNG); empty: none.
};

/// Answer to a request for a page.
struct HttpReply {
  unsigned status = 200;
  const char* type = "text/plain; charset=utf-8";
  std::string_view body;  ///< Constant text, unless `text` is not empty.
  std::string text = {};
  std::string_view content() const { return text.empty() ? body : std::string_view(text); }
};

/// Header of a reply, by name (with the colon) and value.
struct HttpHeader {
  const char* name;
  std::string value;
};
/// Returns the headers of every reply: no foreign content, no caching, no referrer.
/// @param in_frames  whether pages of this machine (127.0.0.1, localhost) may show the page in a frame;
/// otherwise no page may
const std::vector<HttpHeader>& http_headers(bool in_frames);

/// Returns the reply to a request.
/// @param path  decoded path  @param has_token  whether the request has the right token
/// @param token  for addresses in the list of scenes
HttpReply reply_to(std::string_view path, bool has_token, const std::string& token,
                   const std::vector<SceneEntry>& scenes);

}  // namespace palpate::live
