#include "plot_json.h"

#include <cmath>

#include "drawable.h"
#include "json.h"

namespace palpate::report {
namespace {

/// Columns per curve; more than in the SVG, since the reader can zoom.
constexpr std::size_t kColumns = 1500;

const char* name_of(Mark mark) {
  switch (mark) {
    case Mark::kPoints: return "points";
    case Mark::kLinePoints: return "line-points";
    case Mark::kDashed: return "dashed";
    case Mark::kArea: return "area";
    case Mark::kLine: break;
  }
  return "line";
}

Json json_of(const Series& series) {
  Json out = {{"name", series.name},
              {"mark", name_of(series.mark)},
              {"colour", series.colour},
              {"x", series.x},
              {"y", series.y}};
  if (series.width > 0.0) out["width"] = series.width;
  if (!series.labels.empty()) out["labels"] = series.labels;
  if (series.labels_below) out["labels_below"] = true;
  if (!series.hollow.empty()) out["hollow"] = series.hollow;
  if (!series.group.empty()) out["group"] = series.group;
  if (!series.reading.empty()) out["reading"] = series.reading;
  if (!series.notes.empty()) out["notes"] = series.notes;
  return out;
}

}  // namespace

std::string plot_json(const Plot& plot) {
  Json out = {{"title", plot.title},     {"x_label", plot.x_label},
              {"y_label", plot.y_label}, {"log_x", plot.log_x},
              {"log_y", plot.log_y},     {"height", plot.height},
              {"floor_y", plot.floor_y}, {"floor_label", plot.floor_label}};
  if (!std::isfinite(plot.floor_y)) out["floor_y"] = nullptr;
  out["levels"] = Json::array();
  for (const Level& level : plot.levels) out["levels"].push_back({{"y", level.y}, {"label", level.label}});
  out["series"] = Json::array();
  for (const Series& series : drawable_series(plot, kColumns)) out["series"].push_back(json_of(series));
  return out.dump();
}

}  // namespace palpate::report
