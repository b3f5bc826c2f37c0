#include "drawable.h"

#include <cmath>

#include "palpate/core/error.h"
#include "style.h"
#include "thin.h"

namespace palpate::report {
namespace {

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

Series clean(const Plot& plot, const Series& series, std::size_t pixels) {
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
  if (out.labels.empty() && out.hollow.empty() && out.notes.empty()) thin(out.x, out.y, pixels);
  return out;
}

}  // namespace

std::vector<Series> drawable_series(const Plot& plot, std::size_t pixels) {
  std::vector<Series> out;
  for (const Series& series : plot.series)
    if (Series c = clean(plot, series, pixels); !c.x.empty()) out.push_back(std::move(c));
  if (out.empty())
    fail("plot \"{}\": there is nothing to draw: no point is finite{}",
         plot.title.empty() ? plot.y_label : plot.title,
         plot.log_x || plot.log_y ? " and positive, as a logarithmic axis needs" : "");
  std::size_t next = 0;
  for (Series& series : out)
    if (series.colour.empty()) series.colour = kPalette[next++ % kPalette.size()];
  return out;
}

}  // namespace palpate::report
