#pragma once
#include <vector>

namespace palpate::mesh {

/// Graded division of [-1, 1]: maps s in [-1, 1] to
///     A (s + (g - 1)(s - s^3/3)),   A = 1/(1 + 2(g - 1)/3),
/// whose slope A (1 + (g - 1)(1 - s^2)) is g times as large in the middle as at the ends.  Odd in s; the ends
/// are exact.
double graded(double s, double grading);

/// Returns the number of cells of that division of `length` that gives end cells of about `element_size`; at
/// least one.
int graded_cells(double length, double element_size, double grading);

/// Returns cells + 1 coordinates from -length/2 to length/2.
std::vector<double> graded_coordinates(double length, int cells, double grading);

}  // namespace palpate::mesh
