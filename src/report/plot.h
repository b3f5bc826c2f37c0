#pragma once
#include <array>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::report {

/// Colours of series, in order. The first eight have a contrast of 3:1 against both the light and the dark
/// page, and differ in lightness, too, for readers with a colour deficiency.
inline constexpr std::array<std::string_view, 12> kPalette = {"#2b7bba", "#d9720a", "#2a9461", "#b0529e",
                                                              "#d1495b", "#0f9aa8", "#8a6d3b", "#6a5acd",
                                                              "#8fae1b", "#c2185b", "#4c6a7d", "#e0a100"};

/// Drawing style of a series; kArea is a line with the area down to the axis filled.
enum class Mark { kLine, kPoints, kLinePoints, kDashed, kArea };

/// Curve of a plot. Points that are not finite (or not positive on a logarithmic axis) are left out.
struct Series {
  std::string name;  ///< Name in the key; empty: not in the key
  std::vector<double> x, y;
  Mark mark = Mark::kLine;
  std::vector<std::string> labels = {};  ///< Text next to each point; empty: none
  /// Whether labels are to the left of and below their points instead of to the right and above
  bool labels_below = false;
  /// Points drawn as rings (not resolved by the reference); empty: none
  std::vector<bool> hollow = {};
  /// "#rrggbb", or "ink" (text) or "faint" (background) for that colour of the style sheet; empty: the next
  /// colour of the palette
  std::string colour = {};
  double width = 0.0;                   ///< Line width; 0: default of the mark
  std::string group = {};               ///< Entry of the key that switches the series; empty: `name`
  std::string reading = {};             ///< Name shown with a value under the cursor; empty: `name`
  std::vector<std::string> notes = {};  ///< Note per point, shown with its value; empty: none
};

/// Horizontal line with a label: a force limit, an acceptance limit.
struct Level {
  double y = 0.0;
  std::string label;
};

/// Part of the x axis with a name: a phase of a motion.
struct Span {
  double from, to;
  std::string label;
};

/// Plot of several series.
struct Plot {
  std::string title, x_label, y_label;
  bool log_x = false, log_y = false;
  std::vector<Series> series;
  std::vector<Level> levels = {};
  std::vector<Span> spans = {};  ///< In order, without overlap
  /// Upper end of the shaded area: the error of the reference; NaN: none
  double floor_y = std::numeric_limits<double>::quiet_NaN();
  std::string floor_label = {};
  int height = 400;  ///< Height on a wide page, in CSS pixels
};

/// Returns an empty plot with two logarithmic axes.
Plot log_log_plot(const std::string& x_label, const std::string& y_label);

/// Returns a plot as JSON, from which the script of the page draws it (src/report/page/src/plots.js): labels
/// and axes, `series` with name, mark, colour, x, y and texts of points, `levels`, floor. Points that cannot
/// be drawn and series without remaining points are left out; long curves are thinned, and keep their peaks
/// (thin.h).
/// @throws Error if there is nothing to draw
std::string plot_json(const Plot& plot);

}  // namespace palpate::report
