#include "report/plot.h"

#include <cmath>

#include "json.h"
#include "palpate/core/error.h"
#include "thin.h"

namespace palpate::report {
namespace {

/// Columns to which curves are thinned; more than a page has pixels, since the reader can zoom.
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

bool is_drawable(const Plot& plot, double x, double y) {
  return std::isfinite(x) && std::isfinite(y) && (!plot.log_x || x > 0.0) && (!plot.log_y || y > 0.0);
}

/// Keeps the entries of per-point data whose index is in `kept`.
template <class T>
void keep(std::vector<T>& values, const std::vector<std::size_t>& kept, const char* what, std::size_t points,
          const std::string& name) {
  if (values.empty()) return;
  PALPATE_CHECK(values.size() == points, "series \"{}\": {} {} of {} points", name, values.size(), what,
                points);
  std::vector<T> out;
  for (const std::size_t i : kept) out.push_back(values[i]);
  values = std::move(out);
}

/// Returns the series with the points that can be drawn.
Series drawable(const Plot& plot, const Series& series) {
  const std::size_t points = series.x.size();
  PALPATE_CHECK(points == series.y.size(), "series \"{}\": {} x, {} y", series.name, points, series.y.size());
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < points; ++i)
    if (is_drawable(plot, series.x[i], series.y[i])) kept.push_back(i);
  Series out = series;
  keep(out.x, kept, "x", points, series.name);
  keep(out.y, kept, "y", points, series.name);
  keep(out.labels, kept, "labels", points, series.name);
  keep(out.hollow, kept, "rings", points, series.name);
  keep(out.notes, kept, "notes", points, series.name);
  if (out.labels.empty() && out.hollow.empty() && out.notes.empty()) thin(out.x, out.y, kColumns);
  return out;
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

Plot log_log_plot(const std::string& x_label, const std::string& y_label) {
  return {.title = "", .x_label = x_label, .y_label = y_label, .log_x = true, .log_y = true, .series = {}};
}

std::string plot_json(const Plot& plot) {
  Json out = {{"title", plot.title},     {"x_label", plot.x_label},
              {"y_label", plot.y_label}, {"log_x", plot.log_x},
              {"log_y", plot.log_y},     {"height", plot.height},
              {"floor_y", plot.floor_y}, {"floor_label", plot.floor_label}};
  if (!std::isfinite(plot.floor_y)) out["floor_y"] = nullptr;
  out["levels"] = Json::array();
  for (const Level& level : plot.levels) out["levels"].push_back({{"y", level.y}, {"label", level.label}});
  out["spans"] = Json::array();
  for (const Span& span : plot.spans)
    out["spans"].push_back({{"from", span.from}, {"to", span.to}, {"label", span.label}});
  out["series"] = Json::array();
  std::size_t next = 0;
  for (const Series& series : plot.series) {
    Series drawn = drawable(plot, series);
    if (drawn.x.empty()) continue;
    if (drawn.colour.empty()) drawn.colour = kPalette[next++ % kPalette.size()];
    out["series"].push_back(json_of(drawn));
  }
  if (out["series"].empty())
    fail("plot \"{}\": there is nothing to draw: no point is finite{}",
         plot.title.empty() ? plot.y_label : plot.title,
         plot.log_x || plot.log_y ? " and positive, as a logarithmic axis needs" : "");
  return out.dump();
}

}  // namespace palpate::report
