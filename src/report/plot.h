#pragma once
#include <limits>
#include <string>
#include <vector>

namespace palpate::report {

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
  /// "#rrggbb", or "ink" for the text colour; empty: the next colour of the palette
  std::string colour = {};
  double width = 0.0;  ///< Line width; 0: default of the mark

  // shown by the script of the page
  std::string group = {};               ///< Entry of the key that switches the series; empty: `name`
  std::string reading = {};             ///< Name shown with a value under the cursor; empty: `name`
  std::vector<std::string> notes = {};  ///< Note per point, shown with its value; empty: none
};

/// Horizontal line with a label: a force limit, an acceptance limit.
struct Level {
  double y = 0.0;
  std::string label;
};

/// Plot of several series.
struct Plot {
  std::string title, x_label, y_label;
  bool log_x = false, log_y = false;
  std::vector<Series> series;
  std::vector<Level> levels = {};
  /// Upper end of the shaded area: the error of the reference; NaN: none
  double floor_y = std::numeric_limits<double>::quiet_NaN();
  std::string floor_label = {};
  int width = 760, height = 400;
};

/// Draws the plot with gnuplot and returns it as one SVG document. Long curves are thinned to the resolution
/// that the width allows; peaks are kept.
/// @throws Error if there is nothing to draw, if gnuplot is not installed (with the name of the package), or
/// with the message of gnuplot
std::string plot_svg(const Plot& plot);

}  // namespace palpate::report
