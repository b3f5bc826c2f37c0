#pragma once
#include <nlohmann/json.hpp>
#include <string>

/// Returns the numbers of the chart with this y axis label.
inline nlohmann::json chart_of(const std::string& html, const std::string& y_label) {
  const std::string begin = "class=\"plot-data\">", end = "</script>";
  for (std::size_t at = html.find(begin); at != std::string::npos; at = html.find(begin, at + 1)) {
    const std::size_t from = at + begin.size();
    nlohmann::json data = nlohmann::json::parse(html.substr(from, html.find(end, from) - from));
    if (data["y_label"] == y_label) return data;
  }
  return nullptr;
}
