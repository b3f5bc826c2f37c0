#pragma once

/// Loops over points stored as columns of coordinates, eight lanes at a time, compiled for the processor at
/// hand. Every array is padded to a multiple of kLanes; padding repeats the first entry.
namespace palpate::proxy {

inline constexpr int kLanes = 8;
/// Returns the smallest multiple of kLanes that is at least `count`.
inline constexpr int padded(int count) { return (count + kLanes - 1) / kLanes * kLanes; }

/// Columns of x, y and z coordinates.
struct Columns {
  const double *x, *y, *z;
};
/// Writable columns of x, y and z coordinates.
struct MutableColumns {
  double *x, *y, *z;
};

/// Copies the points at these indices, relative to an origin: out_i = p[index_i] - origin.
void gather(Columns p, const int* index, int count, const double origin[3], MutableColumns out);

/// Copies points stored as x y z, `stride` doubles apart, into columns (padded with the first point) and
/// returns the largest |p_i - offset - linear then_i|^2; NaN when a point is not finite.
/// @param linear  3 x 3, row by row
/// @pre the columns are padded(count) long
double take(const double* points, int stride, int count, Columns then, const double linear[9],
            const double offset[3], MutableColumns out);

/// Computes sums = {sum x, sum y, sum z, then row by row sum p q^T} of points p and coefficients q.
void moments(Columns p, Columns q, int count, double sums[12]);

/// Computes squares_i = |p_i - offset - linear rest_i|^2; returns the largest, NaN when one is not finite.
double residuals(Columns p, Columns rest, int count, const double linear[9], const double offset[3],
                 double* squares);

/// Computes out = linear rest + offset, and the box around it.
void move(Columns rest, int count, const double linear[9], const double offset[3], MutableColumns out,
          double low[3], double high[3]);

/// Returns the index of the entry farthest along a direction; the first of equals.
int farthest(Columns p, int count, const double direction[3]);
/// Returns the largest direction . p.
double most_along(Columns p, int count, const double direction[3]);

/// Hull and the margin that it grows by.
struct HullColumns {
  Columns corners;
  int count;                 ///< padded
  const double *low, *high;  ///< box around the grown hull
  const double* inside;      ///< a point of the hull
  double margin;
};

/// Tests which balls may be near a hull: near[i] = 0 proves that ball i and the grown hull do not meet. Eight
/// balls at a time, by the search of apart.h, in at most `steps` steps.
/// @param count  number of balls, padded like the arrays
void balls_near(const HullColumns& hull, Columns centres, const double* radii, int count, int steps,
                unsigned char* near);

/// Performs the test of balls_near for one direction: excludes ball i where direction . centre - radius >
/// limit.  Only clears entries of `near`.
void balls_beyond(const double direction[3], double limit, Columns centres, const double* radii, int count,
                  unsigned char* near);

}  // namespace palpate::proxy
