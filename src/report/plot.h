#pragma once
#include <limits>
#include <string>
#include <vector>

namespace palpate::report {

/// kArea: a line, and colour from it down to the axis.
enum class Mark { kLine, kPoints, kLinePoints, kDashed, kArea };

/// One curve.  Points that are not finite (or not positive on a logarithmic axis) are left out.
struct Series {
  std::string name;  ///< in the key; empty: not in the key
  std::vector<double> x, y;
  Mark mark = Mark::kLine;
  std::vector<std::string> labels = {};  ///< text beside each point; empty: none
  /// labels stand to the left of and below their points, not to the right and above
  bool labels_below = false;
  /// points drawn as rings (not resolved by the reference); empty: none
  std::vector<bool> hollow = {};
  /// "#rrggbb", or "ink" for the text's colour; empty: the next of the palette
  std::string colour = {};
  double width = 0.0;  ///< of the line; 0: the mark's own

  // what the page's script shows, where there is one
  std::string group = {};               ///< the key's entry that switches it; empty: `name`
  std::string reading = {};             ///< its name beside a value that is read; empty: `name`
  std::vector<std::string> notes = {};  ///< of each point, read with its value; empty: none
};

/// A horizontal line with its name: a force limit, a bar.
struct Level {
  double y = 0.0;
  std::string label;
};

struct Plot {
  std::string title, x_label, y_label;
  bool log_x = false, log_y = false;
  std::vector<Series> series;
  std::vector<Level> levels = {};
  /// everything below is shaded: the reference's own error
  double floor_y = std::numeric_limits<double>::quiet_NaN();
  std::string floor_label = {};
  int width = 760, height = 400;
};

/// The plot as one SVG document, drawn by gnuplot.  Long curves are thinned to what the width can show; peaks
/// are kept.
/// @throws Error when there is nothing to draw, when gnuplot is not installed (naming the package), or with
///   gnuplot's own message
std::string plot_svg(const Plot& plot);

}  // namespace palpate::report
