#include "scene/view.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace palpate::scene {
namespace {

struct NamedDirection {
  const char* name;
  std::array<double, 3> to_eye;
};
constexpr std::array<NamedDirection, 6> kDirections = {{{"front", {0, -1, 0}},
                                                        {"back", {0, 1, 0}},
                                                        {"left", {-1, 0, 0}},
                                                        {"right", {1, 0, 0}},
                                                        {"top", {0, 0, 1}},
                                                        {"bottom", {0, 0, -1}}}};

}  // namespace

const std::vector<std::string>& view_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> out;
    for (const NamedDirection& one : kDirections) out.emplace_back(one.name);
    return out;
  }();
  return names;
}

std::optional<Vec3> view_direction(const std::string& text) {
  for (const NamedDirection& one : kDirections)
    if (text == one.name) return Vec3(one.to_eye[0], one.to_eye[1], one.to_eye[2]);
  Vec3 out;
  const char *at = text.data(), *end = at + text.size();
  for (int i = 0; i < 3; ++i) {
    while (at != end && *at == ' ') ++at;
    const auto [stop, error] = std::from_chars(at, end, out[i]);
    if (error != std::errc()) return {};
    at = stop;
    while (at != end && *at == ' ') ++at;
    if (i < 2 && (at == end || *at++ != ',')) return {};
  }
  if (at != end || !out.allFinite() || !(out.norm() > 0.0)) return {};
  return out;
}

}  // namespace palpate::scene
