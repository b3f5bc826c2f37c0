#include "inline_svg.h"

#include "palpate/core/error.h"

namespace palpate::report {
namespace {

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

/// Removes every `begin ... end`, both included.
void remove_all(std::string& text, const std::string& begin, const std::string& end) {
  for (std::size_t at = text.find(begin); at != std::string::npos; at = text.find(begin, at)) {
    const std::size_t stop = text.find(end, at + begin.size());
    if (stop == std::string::npos) return;
    text.erase(at, stop + end.size() - at);
  }
}

}  // namespace

std::string inline_svg(const std::string& document, const std::string& id_prefix) {
  const std::size_t begin = document.find("<svg"), end = document.rfind("</svg>");
  if (begin == std::string::npos || end == std::string::npos)
    fail("not an SVG document: no <svg> element; it begins with \"{}\"", document.substr(0, 60));
  std::string svg = document.substr(begin, end + 6 - begin);
  remove_all(svg, "<title>", "</title>");
  remove_all(svg, "<desc>", "</desc>");
  remove_all(svg, "<filter", "</filter>");
  remove_all(svg, " xmlns:xlink=\"", "\"");
  remove_all(svg, " xmlns=\"", "\"");
  replace_all(svg, "xlink:href", "href");
  replace_all(svg, "id='", "id='" + id_prefix);
  replace_all(svg, "id=\"", "id=\"" + id_prefix);
  replace_all(svg, "href='#", "href='#" + id_prefix);
  for (const char* attribute : {"fill", "stroke", "color"}) {
    replace_all(svg, fmt::format("{}=\"black\"", attribute), fmt::format("{}=\"currentColor\"", attribute));
    replace_all(svg, fmt::format("{}='black'", attribute), fmt::format("{}='currentColor'", attribute));
  }
  // the form in which gnuplot writes a requested colour
  for (const char* black : {"rgb(  0,   0,   0)", "rgb(0,0,0)"}) replace_all(svg, black, "currentColor");
  // color="currentColor" inherits, as intended.
  replace_all(svg, "<svg", "<svg class=\"plot\" role=\"img\"");
  return svg;
}

}  // namespace palpate::report
