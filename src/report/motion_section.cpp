#include <algorithm>
#include <cmath>

#include "core/time_text.h"
#include "palpate/core/error.h"
#include "palpate/store/run_reader.h"
#include "sections.h"
#include "surface_json.h"

namespace palpate::report {

namespace {

std::optional<Vec3> vector_of(const Json& object, const char* key) {
  if (!object.is_object() || !object.contains(key)) return {};
  const Json& list = object[key];
  if (!list.is_array() || list.size() != 3 ||
      !std::all_of(list.begin(), list.end(), [](const Json& one) { return one.is_number(); }))
    return {};
  return Vec3(list[0].get<double>(), list[1].get<double>(), list[2].get<double>());
}

/// Completes a view by that of the summary: its pictures have the same.
void add_summary(ViewSettings& view, const Json& summary) {
  const Json pictures = section_of(summary, "pictures");
  if (const auto from = vector_of(pictures, "view_direction")) view.from = *from;
  if (const auto up = vector_of(pictures, "view_up")) view.up = *up;
  if (const auto target = vector_of(pictures, "view_target_m")) view.target_m = *target;
  if (const double zoom = number_at(pictures, "view_zoom"); zoom > 0.0) view.zoom = zoom;
  if (pictures.contains("free_bodies"))
    for (const Json& name : pictures["free_bodies"])
      if (name.is_string()) view.free_bodies.push_back(name.get<std::string>());
  for (const Json& hand : list_of(summary, "hands"))
    if (const std::string name = text_at(hand, "name"); !name.empty()) view.tools.push_back(name);
}

}  // namespace

void add_motion(Page& page, const std::filesystem::path& vtkhdf, const Json& summary, double shown_at_s,
                const FirstView& first) {
  ViewSettings view{.shown_at_s = shown_at_s};
  add_summary(view, summary);
  if (first.from) view.from = *first.from;
  if (first.zoom) view.zoom = *first.zoom;
  try {
    const std::string json = surface_json(store::RunReader(vtkhdf.string()), {}, view);
    if (!json.empty())
      page.add_view(
          json,
          fmt::format(
              "Recorded motion{}: drag to rotate; after a click, the wheel or the keys + and - zoom.{}",
              std::isfinite(shown_at_s)
                  ? fmt::format(", starting at the first state after the peak force on the hand (at "
                                "{} s)",
                                time_text(shown_at_s))
                  : "",
              view.free_bodies.empty() ? ""
                                       : " Displacements of free bodies are without their rigid motion."));
  } catch (const Error& e) { page.add_missing_figure("motion of the bodies", e.what()); }
}

}  // namespace palpate::report
