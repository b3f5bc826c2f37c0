#include "live/http.h"

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "live/page_files.h"
#include "report/embedded_scripts.h"

namespace palpate::live {
namespace {

constexpr const char* kHtml = "text/html; charset=utf-8";
constexpr const char* kScript = "text/javascript; charset=utf-8";
constexpr const char* kStyle = "text/css; charset=utf-8";
constexpr const char* kJson = "application/json";

HttpReply refusal() {
  return {403, "text/plain; charset=utf-8",
          "This page needs its token: open the whole address that palpate touch printed.\n"};
}

HttpReply scene_list(const std::string& token, const std::vector<SceneEntry>& scenes) {
  nlohmann::json list = nlohmann::json::array();
  for (const SceneEntry& scene : scenes) {
    nlohmann::json picture = nullptr;
    if (!scene.picture.empty()) picture = "/picture/" + scene.name + ".png?token=" + token;
    list.push_back({{"name", scene.name}, {"summary", scene.summary}, {"picture", picture}});
  }
  return {200, kJson, {}, list.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)};
}

HttpReply picture(std::string_view name, const std::vector<SceneEntry>& scenes) {
  for (const SceneEntry& scene : scenes) {
    if (scene.picture.empty() || scene.name + ".png" != name) continue;
    std::ifstream file(scene.picture, std::ios::binary);
    std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    if (!bytes.empty()) return {200, "image/png", {}, std::move(bytes)};
  }
  return {404, "text/plain; charset=utf-8", "There is no such picture.\n"};
}

}  // namespace

const std::vector<HttpHeader>& http_headers(bool in_frames) {
  const auto with_ancestors = [](const std::string& ancestors) {
    return std::vector<HttpHeader>{
        {"content-security-policy:",
         "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
         "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors " +
             ancestors},
        {"x-content-type-options:", "nosniff"},
        {"referrer-policy:", "no-referrer"},
        {"cross-origin-resource-policy:", "same-origin"},
        {"cache-control:", "no-store"}};
  };
  static const std::vector<HttpHeader> alone = with_ancestors("'none'");
  static const std::vector<HttpHeader> framed = with_ancestors("http://127.0.0.1:* http://localhost:*");
  return in_frames ? framed : alone;
}

HttpReply reply_to(std::string_view path, bool has_token, const std::string& token,
                   const std::vector<SceneEntry>& scenes) {
  if (path == "/viewer.js") return {200, kScript, viewer_script()};
  if (path == "/three.js") return {200, kScript, report::three_script()};
  if (path == "/viewer.css") return {200, kStyle, viewer_style()};
  constexpr std::string_view kPicture = "/picture/";
  const bool is_known = path == "/" || path == "/scenes" || path.starts_with(kPicture);
  if (!is_known) return {404, "text/plain; charset=utf-8", "There is no such page.\n"};
  if (!has_token) return refusal();
  if (path == "/") return {200, kHtml, viewer_page()};
  if (path == "/scenes") return scene_list(token, scenes);
  return picture(path.substr(kPicture.size()), scenes);
}

}  // namespace palpate::live
