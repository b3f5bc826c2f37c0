#include <fstream>
#include <iterator>

#include "core/markup.h"
#include "palpate/core/error.h"
#include "report/page.h"

namespace palpate::report {
namespace {

namespace fs = std::filesystem;

std::string figure(const std::string& content, const std::string& caption, const char* css = "") {
  return fmt::format("<figure{}>\n", css) + content +
         (caption.empty() ? "" : "\n<figcaption>" + escape_html(caption) + "</figcaption>") + "\n</figure>\n";
}

/// Returns JSON as an HTML element, escaped so that no text in it ends the element.
std::string json_element(const std::string& css, const std::string& json) {
  std::string text;
  text.reserve(json.size());
  for (const char c : json) text += c == '<' ? "\\u003c" : c == '&' ? "\\u0026" : std::string(1, c);
  return "<script type=\"application/json\" class=\"" + css + "\">" + text + "</script>\n";
}

}  // namespace

Page& Page::add_chart(const std::string& json, const std::string& file, const std::string& caption) {
  interacts_ = true;
  body_ += figure("<p class=\"values\">This chart needs JavaScript. Its values are in " + escape_html(file) +
                      ".</p>\n" + json_element("plot-data", json),
                  caption, " class=\"chart\"");
  return *this;
}

Page& Page::add_view(const std::string& json, const std::string& caption) {
  turns_ = true;
  body_ +=
      "<figure class=\"view\" hidden=\"hidden\">\n<div class=\"stage\"></div>\n<div class=\"player\">"
      "<button type=\"button\">Play</button><input type=\"range\" min=\"0\" value=\"0\" "
      "aria-label=\"time\"/><output></output></div>\n" +
      json_element("view-data", json) + "<figcaption>" + escape_html(caption) + "</figcaption>\n</figure>\n";
  return *this;
}

Page& Page::add_png(const fs::path& png, const std::string& caption) {
  std::ifstream in(png, std::ios::binary);
  if (!in) fail("{}: cannot be opened for reading; check the path and its permissions", png.string());
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  if (!bytes.starts_with("\x89PNG\r\n\x1a\n"))
    fail("{}: is not a PNG file; only PNG pictures can be embedded", png.string());
  body_ += figure("<img alt=\"" + escape_html(caption.empty() ? png.stem().string() : caption) +
                      "\" src=\"data:image/png;base64," + base64(bytes) + "\"/>",
                  caption);
  return *this;
}

Page& Page::add_missing_figure(const std::string& caption, const std::string& why) {
  missing_figures_.push_back({caption, why});
  return add_paragraph("Figure not drawn (" + caption + "): " + why);
}

}  // namespace palpate::report
