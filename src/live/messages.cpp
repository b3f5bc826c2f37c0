#include "live/messages.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <nlohmann/json.hpp>

namespace palpate::live {
namespace {

using nlohmann::json;

bool has_only(const json& object, std::initializer_list<std::string_view> keys) {
  return std::all_of(object.items().begin(), object.items().end(), [&](const auto& item) {
    return item.key() == "type" || std::find(keys.begin(), keys.end(), item.key()) != keys.end();
  });
}

const json* find(const json& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}

std::optional<double> number(const json* value) {
  if (!value || !value->is_number()) return {};
  const double out = value->get<double>();
  return std::isfinite(out) ? std::optional(out) : std::nullopt;
}

/// Reads an optional whole number up to `most`; absent is 0.
std::optional<std::uint32_t> whole(const json* value, std::uint32_t most) {
  if (!value) return 0U;
  if (!value->is_number_unsigned()) return {};
  const auto out = value->get<std::uint64_t>();
  return out <= most ? std::optional(static_cast<std::uint32_t>(out)) : std::nullopt;
}

template <std::size_t kCount>
std::optional<std::array<double, kCount>> numbers(const json* value) {
  if (!value || !value->is_array() || value->size() != kCount) return {};
  std::array<double, kCount> out{};
  for (std::size_t i = 0; i < kCount; ++i) {
    const auto one = number(&(*value)[i]);
    if (!one) return {};
    out[i] = *one;
  }
  return out;
}

/// Reads a short printable text.
std::optional<std::string> text(const json* value) {
  if (!value || !value->is_string()) return {};
  const auto& out = value->get_ref<const std::string&>();
  const bool printable = std::all_of(out.begin(), out.end(), [](char c) { return c >= ' ' && c != '\x7f'; });
  return !out.empty() && out.size() <= 200 && printable ? std::optional(out) : std::nullopt;
}

template <class Switch>
std::optional<Message> read_switch(const json& object) {
  const json* on = find(object, "on");
  if (!has_only(object, {"on"}) || !on || !on->is_boolean()) return {};
  return Switch{on->get<bool>()};
}

template <class Plain>
std::optional<Message> read_plain(const json& object) {
  return has_only(object, {}) ? std::optional<Message>(Plain{}) : std::nullopt;
}

std::optional<Message> read_handle(const json& object) {
  if (!has_only(object, {"hand", "position", "rotation", "switches"})) return {};
  const auto hand = whole(find(object, "hand"), 255);
  const auto switches = whole(find(object, "switches"), std::numeric_limits<std::uint32_t>::max());
  const auto position = numbers<3>(find(object, "position"));
  const auto rotation = numbers<4>(find(object, "rotation"));
  if (!hand || !switches || !position || !rotation) return {};
  for (const double x : *position)
    if (std::abs(x) > kFarthest) return {};
  const auto& q = *rotation;
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(norm > 0.5 && norm < 2.0)) return {};
  MoveHandle out;
  out.hand = *hand;
  out.switches = *switches;
  out.target.translation = {(*position)[0], (*position)[1], (*position)[2]};
  out.target.rotation = Quat(q[0] / norm, q[1] / norm, q[2] / norm, q[3] / norm);
  return out;
}

std::optional<Message> read_set(const json& object) {
  const auto key = text(find(object, "key"));
  const auto value = number(find(object, "value"));
  if (!has_only(object, {"key", "value"}) || !key || !value) return {};
  return SetValue{*key, *value};
}

std::optional<Message> read_open(const json& object) {
  const auto scene = text(find(object, "scene"));
  if (!has_only(object, {"scene"}) || !scene) return {};
  return OpenScene{*scene};
}

struct Reader {
  std::string_view type;
  std::optional<Message> (*read)(const json& object);
};
constexpr std::array<Reader, 8> kReaders = {{{"take", read_plain<TakeHandle>},
                                             {"drop", read_plain<DropHandle>},
                                             {"handle", read_handle},
                                             {"set", read_set},
                                             {"reset", read_plain<Reset>},
                                             {"record", read_switch<SetRecording>},
                                             {"open", read_open},
                                             {"pause", read_switch<SetPause>}}};

}  // namespace

std::optional<Message> read_message(std::string_view bytes) {
  if (bytes.size() > kLongestMessage) return {};
  const json object = json::parse(bytes.begin(), bytes.end(), nullptr, false);
  if (!object.is_object()) return {};
  const json* type = find(object, "type");
  if (!type || !type->is_string()) return {};
  const auto& name = type->get_ref<const std::string&>();
  for (const Reader& reader : kReaders)
    if (reader.type == name) return reader.read(object);
  return {};
}

}  // namespace palpate::live
