#include "report/plot.h"

#include <algorithm>
#include <cmath>

#include "axis.h"
#include "drawable.h"
#include "gnuplot.h"
#include "palpate/core/error.h"
#include "style.h"

namespace palpate::report {
namespace {

/// Quotes text for gnuplot, which reads single-quoted text literally (no back-quoted commands, no escapes):
/// only the quote is doubled.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'')
      out += "''";
    else
      out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return out + "'";
}

/// Returns a cell of a data block in double quotes; gnuplot has no escape for the quote itself.
std::string data_cell(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? '\'' : static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  return out + "\"";
}

/// Returns the data block $dI: x, y, label, ring (0 or 1).
std::string data_block(std::size_t index, const Series& series) {
  std::string block = fmt::format("$d{} << EOD\n", index);
  for (std::size_t i = 0; i < series.x.size(); ++i)
    block += fmt::format("{:.9g} {:.9g} {} {}\n", series.x[i], series.y[i],
                         data_cell(series.labels.empty() ? "" : series.labels[i]),
                         !series.hollow.empty() && series.hollow[i] ? 1 : 0);
  return block + "EOD\n";
}

/// Returns the clauses of `plot` for one series: the line, rings over its points, labels.
std::string plot_items(std::size_t index, const Series& series) {
  const std::string colour = series.colour == "ink" ? "black" : series.colour;
  const std::string data = fmt::format("$d{}", index);
  const std::string title =
      series.name.empty() ? "notitle" : fmt::format("title {} noenhanced", quoted(series.name));
  const double width = series.width > 0.0 ? series.width : series.colour == "ink" ? 2.4 : 1.7;
  std::string style = fmt::format("lines lw {}", width);
  if (series.mark == Mark::kDashed) style = "lines dt (6,5) lw 1.4";
  if (series.mark == Mark::kPoints) style = "points pt 7 ps 0.7";
  if (series.mark == Mark::kLinePoints)
    style = fmt::format("linespoints pt 7 ps {} lw {}", width < 1.7 ? 0.45 : 0.7, width);
  std::string items = fmt::format("{} using 1:2 with {} lc rgb '{}' {}", data, style, colour, title);
  if (series.mark == Mark::kArea)
    items = fmt::format("{} using 1:2 with filledcurves x1 fs transparent solid 0.25 lc rgb '{}' notitle, {}",
                        data, colour, items);
  if (std::find(series.hollow.begin(), series.hollow.end(), true) != series.hollow.end())
    items += fmt::format(", {} using 1:($4 > 0 ? $2 : NaN) with points pt 7 ps {} lc rgb 'white' notitle",
                         data, width < 1.7 ? 0.25 : 0.4);
  if (!series.labels.empty())
    items +=
        fmt::format(", {} using 1:2:3 with labels {} font ',11' textcolor rgb '{}' noenhanced notitle", data,
                    series.labels_below ? "right offset -0.8,-0.5" : "left offset 0.8,0.5", colour);
  return items;
}

/// Returns the x axis over all series.
Axis x_axis(const Plot& plot, const std::vector<Series>& series) {
  std::vector<double> values;
  for (const Series& s : series) values.insert(values.end(), s.x.begin(), s.x.end());
  const bool labelled = std::any_of(series.begin(), series.end(),
                                    [](const Series& s) { return !s.labels.empty() && !s.labels_below; });
  const bool below =
      std::any_of(series.begin(), series.end(), [](const Series& s) { return s.labels_below; });
  if (!plot.log_x) return make_axis(values, false, 0.0, labelled ? 0.1 : 0.0);
  return make_axis(values, true, below ? 0.3 : 0.06, labelled ? 0.16 : 0.06);
}

/// Returns the y axis over all series, levels and the floor. Distant levels and floors would compress the
/// data: a level is drawn up to three times the largest value, a floor down to a thirtieth of the least.
Axis y_axis(const Plot& plot, const std::vector<Series>& series) {
  std::vector<double> values;
  for (const Series& s : series) values.insert(values.end(), s.y.begin(), s.y.end());
  const double least = *std::min_element(values.begin(), values.end()),
               greatest = *std::max_element(values.begin(), values.end());
  for (const Level& level : plot.levels)
    if (std::abs(level.y) <= 3.0 * std::max(std::abs(least), std::abs(greatest)) &&
        (!plot.log_y || level.y > 0.0))
      values.push_back(level.y);
  if (plot.log_y && plot.floor_y > least / 30.0) values.push_back(plot.floor_y / 2.5);
  return make_axis(values, plot.log_y, 0.05, 0.07);
}

std::string frame(const Plot& plot, const Axis& x, const Axis& y) {
  std::string s =
      fmt::format("set terminal svg size {},{} dynamic enhanced font 'DejaVu Sans,13' name 'plot'\n",
                  plot.width, plot.height);
  s += "set output 'plot.svg'\nset encoding utf8\nset border 3 lw 0.8\nset tics nomirror out scale 0.6\n";
  s += fmt::format(
      "set grid back lt 1 lw 0.8 lc rgb '{}'\nset key outside top center horizontal noenhanced reverse Left "
      "samplen 2\n",
      kGridColour);
  if (!plot.title.empty()) s += fmt::format("set title {} noenhanced\n", quoted(plot.title));
  s += fmt::format("set xlabel {} noenhanced\nset ylabel {} noenhanced\n", quoted(plot.x_label),
                   quoted(plot.y_label));
  s += axis_commands("x", x) + axis_commands("y", y);
  if (std::isfinite(plot.floor_y) && plot.floor_y > y.low) {
    s += fmt::format(
        "set object 1 rectangle from graph 0,graph 0 to graph 1,first {:.9g} behind fc rgb '{}' fs solid "
        "noborder\n",
        std::min(plot.floor_y, y.high), kFloorColour);
    s += fmt::format("set label {} at graph 0.012,first {:.9g} offset 0,-0.7 left font ',11' noenhanced\n",
                     quoted(plot.floor_label), std::min(plot.floor_y, y.high));
  }
  for (const Level& level : plot.levels) {
    if (!(level.y > y.low && level.y < y.high)) continue;
    s += fmt::format(
        "set arrow from graph 0,first {0:.9g} to graph 1,first {0:.9g} nohead dt (6,5) lw 1.2 lc rgb "
        "'#d1495b'\n",
        level.y);
    s += fmt::format(
        "set label {} at graph 0.988,first {:.9g} offset 0,-0.7 right font ',11' textcolor rgb '#d1495b' "
        "noenhanced\n",
        quoted(level.label), level.y);
  }
  return s;
}

}  // namespace

std::string plot_svg(const Plot& plot) {
  const std::vector<Series> series = drawable_series(plot, static_cast<std::size_t>(plot.width));
  std::string script = frame(plot, x_axis(plot, series), y_axis(plot, series));
  std::string items;
  for (std::size_t i = 0; i < series.size(); ++i) {
    script += data_block(i, series[i]);
    items += (i > 0 ? ", \\\n  " : "") + plot_items(i, series[i]);
  }
  return run_gnuplot(script + "plot " + items + "\n");
}

}  // namespace palpate::report
