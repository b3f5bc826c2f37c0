#include "palpate/core/error.h"
#include "scene/keys.h"
#include "scene/view.h"

namespace palpate::scene {
namespace {

Vec3 read_nonzero(const Value& value) {
  const Vec3 out = read_vec3(value, any());
  if (!(out.norm() > 0.0))
    refuse(location(value.node.source()), value.where,
           fmt::format("{} = [0, 0, 0] must not be zero: it is a direction", value.key));
  return out;
}

void read_direction(const Value& value, ViewSpec& spec) {
  if (!value.node.is_string()) {
    spec.direction = read_nonzero(value);
    return;
  }
  const std::string text = read_text(value, {});
  spec.direction = view_direction(text);
  if (!spec.direction)
    refuse(location(value.node.source()), value.where,
           fmt::format("{} = \"{}\" must be {} or three numbers, not all zero, such as \"1,-2,0.5\"{}",
                       value.key, text, choices(view_names()), suggestion(text, view_names())));
}

}  // namespace

const KeyTable<ViewSpec>& view_keys() {
  static const KeyTable<ViewSpec> keys = {
      own_key<ViewSpec>("direction", read_direction, "text or three numbers", "chosen by the picture",
                        "from the scene to the eye: front (-y), back, left (-x), right, top, bottom, or "
                        "[x, y, z]"),
      own_key<ViewSpec>(
          "target_m", [](const Value& value, ViewSpec& spec) { spec.target_m = read_vec3(value, any()); },
          "three numbers", "the middle of the scene", "point in the middle of the picture"),
      number("zoom", &ViewSpec::zoom, closed(0.1, 100.0, "1 shows the whole scene"),
             "magnification; 1 shows the whole scene"),
      own_key<ViewSpec>(
          "up", [](const Value& value, ViewSpec& spec) { spec.up = read_nonzero(value); }, "three numbers",
          "[0.0, 0.0, 1.0]", "upward direction of the picture"),
  };
  return keys;
}

}  // namespace palpate::scene
