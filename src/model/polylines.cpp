#include "polylines.h"

#include <cmath>
#include <numbers>

namespace palpate::model {

std::vector<Polyline> cut_at_corners(const std::vector<Polyline>& lines) {
  const double least = std::cos(30 * std::numbers::pi / 180);
  std::vector<Polyline> out;
  for (const Polyline& line : lines) {
    if (line.size() < 2) continue;
    Polyline piece{line[0]};
    for (std::size_t i = 1; i < line.size(); ++i) {
      piece.push_back(line[i]);
      if (i + 1 == line.size() ||
          (line[i] - line[i - 1]).normalized().dot((line[i + 1] - line[i]).normalized()) >= least)
        continue;
      out.push_back(piece);
      piece = {line[i]};
    }
    out.push_back(piece);
    // A closed line with its only corner at its start would be taken for a smooth one: it is cut in the
    // middle, so that the corner is an end.
    if (const Polyline& last = out.back();
        last.size() == line.size() && line.size() > 3 && line.front() == line.back() &&
        (line[1] - line[0]).normalized().dot((line.back() - line[line.size() - 2]).normalized()) < least) {
      const auto half = static_cast<std::ptrdiff_t>(line.size() / 2);
      out.back() = Polyline(line.begin(), line.begin() + half + 1);
      out.emplace_back(line.begin() + half, line.end());
    }
  }
  return out;
}

}  // namespace palpate::model
