#include "lattice.h"

#include <algorithm>
#include <cmath>

namespace palpate::mesh {
namespace {
double end_slope(double grading) { return 1.0 / (1.0 + 2.0 * (grading - 1.0) / 3.0); }
}  // namespace

double graded(double s, double grading) {
  if (std::abs(s) == 1.0) return s;
  return end_slope(grading) * (s + (grading - 1.0) * (s - s * s * s / 3.0));
}

int graded_cells(double length, double element_size, double grading) {
  return std::max(1, static_cast<int>(std::lround(end_slope(grading) * length / element_size)));
}

std::vector<double> graded_coordinates(double length, int cells, double grading) {
  std::vector<double> out;
  for (int i = 0; i <= cells; ++i)
    out.push_back(0.5 * length * graded(static_cast<double>(2 * i - cells) / cells, grading));
  return out;
}

}  // namespace palpate::mesh
