#include "scene/check.h"
#include "scene/reader.h"

namespace palpate::scene {

std::optional<Selection> box_or_sphere(const Document& doc, const std::string& key,
                                       const std::string& where) {
  const auto has = [&](const char* word) { return given(doc, key + "." + word); };
  const bool box = has("box_min_m") || has("box_max_m"), sphere = has("centre_m") || has("radius_m");
  if (box && sphere)
    refuse(location(doc, key + ".radius_m"), where,
           "a box and a sphere exclude each other; remove box_min_m and box_max_m, or centre_m and radius_m");
  for (const char* word : {"box_min_m", "box_max_m"})
    if (box && !has(word)) refuse(location(doc, key), where, fmt::format("{} is missing", word));
  for (const char* word : {"centre_m", "radius_m"})
    if (sphere && !has(word)) refuse(location(doc, key), where, fmt::format("{} is missing", word));
  if (box) return Selection::kBox;
  return sphere ? std::optional(Selection::kSphere) : std::nullopt;
}

}  // namespace palpate::scene
