#pragma once
#include <cctype>
#include <string>
#include <vector>

/// Error of a page as XML: a tag that is not closed, or closed out of order, or a bare < or &. Empty if there
/// is none. A small checker that avoids a dependency on an XML library; style and comments are skipped.
inline std::string well_formed_problem(const std::string& html) {
  std::vector<std::string> open;
  for (std::size_t at = 0; at < html.size(); ++at) {
    if (html[at] == '&') {
      const std::size_t end = html.find(';', at);
      if (end == std::string::npos || end - at > 8) return "a bare & at " + html.substr(at, 40);
    }
    if (html[at] != '<') continue;
    if (html.compare(at, 9, "<![CDATA[") == 0) {
      at = html.find("]]>", at);
      if (at == std::string::npos) return "a CDATA section is never closed";
      continue;
    }
    if (html.compare(at, 2, "<!") == 0) {
      at = html.find('>', at);
      continue;
    }
    std::size_t end = at + 1;
    for (char quote = 0; end < html.size() && (quote != 0 || html[end] != '>'); ++end) {
      if (quote != 0 && html[end] == '<') return "a < inside an attribute at " + html.substr(at, 40);
      if (quote == 0 && (html[end] == '"' || html[end] == '\''))
        quote = html[end];
      else if (html[end] == quote)
        quote = 0;
    }
    if (end >= html.size()) return "a tag is never closed: " + html.substr(at, 40);
    const bool closing = html[at + 1] == '/', empty = html[end - 1] == '/';
    std::size_t name_end = at + 1 + closing;
    while (std::isalnum(static_cast<unsigned char>(html[name_end])) != 0) ++name_end;
    const std::string name = html.substr(at + 1 + closing, name_end - at - 1 - closing);
    if (name.empty()) return "a bare < at " + html.substr(at, 40);
    if (closing) {
      if (open.empty() || open.back() != name)
        return "</" + name + "> closes " + (open.empty() ? "nothing" : open.back());
      open.pop_back();
    } else if (!empty) {
      open.push_back(name);
    }
    at = end;
    if (name == "style" && !closing) at = html.find("</style>", at) - 1;
  }
  return open.empty() ? "" : "<" + open.back() + "> is never closed";
}
