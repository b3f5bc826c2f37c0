#pragma once

/// Loops over points stored coordinate by coordinate, eight side by side, for the processor that it runs on.
/// Every array is as long as a multiple of kLanes; what fills it up repeats the first entry.
namespace palpate::proxy {

inline constexpr int kLanes = 8;
inline constexpr int padded(int count) { return (count + kLanes - 1) / kLanes * kLanes; }

struct Columns {
  const double *x, *y, *z;
};
struct MutableColumns {
  double *x, *y, *z;
};

/// sums = {sum x, sum y, sum z, then row by row sum p q^T} of points p and coefficients q.
void moments(Columns p, Columns q, int count, double sums[12]);

/// squares_i = |p_i - offset - linear rest_i|^2; returns the largest, NaN when one is not finite.
double residuals(Columns p, Columns rest, int count, const double linear[9], const double offset[3], double* squares);

/// out = linear rest + offset, and the box around it.
void move(Columns rest, int count, const double linear[9], const double offset[3], MutableColumns out, double low[3], double high[3]);

/// The entry farthest along a direction; the first of equals.
int farthest(Columns p, int count, const double direction[3]);
/// How far that is: direction . p.
double most_along(Columns p, int count, const double direction[3]);

/// Whether the hull of the points is proven farther than `reach` from a centre: see apart.h.  @param witness  a point of the hull, in and out
bool ball_apart(Columns p, int count, const double centre[3], double reach, int steps, double witness[3]);

}  // namespace palpate::proxy
