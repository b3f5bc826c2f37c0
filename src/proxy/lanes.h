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

/// What stands at these indices, from an origin.
void gather(Columns p, const int* index, int count, const double origin[3], MutableColumns out);

/// Takes points that stand as x y z, `stride` apart, into columns (filled up with the first); returns the
/// largest |p_i - offset - linear then_i|^2, NaN when one is not finite.
/// @pre the columns are padded(count) long
double take(const double* points, int stride, int count, Columns then, const double linear[9],
            const double offset[3], MutableColumns out);

/// sums = {sum x, sum y, sum z, then row by row sum p q^T} of points p and coefficients q.
void moments(Columns p, Columns q, int count, double sums[12]);

/// squares_i = |p_i - offset - linear rest_i|^2; returns the largest, NaN when one is not finite.
double residuals(Columns p, Columns rest, int count, const double linear[9], const double offset[3],
                 double* squares);

/// out = linear rest + offset, and the box around it.
void move(Columns rest, int count, const double linear[9], const double offset[3], MutableColumns out,
          double low[3], double high[3]);

/// The entry farthest along a direction; the first of equals.
int farthest(Columns p, int count, const double direction[3]);
/// How far that is: direction . p.
double most_along(Columns p, int count, const double direction[3]);

/// A hull, and what it grows by.
struct HullColumns {
  Columns corners;
  int count;                 ///< padded
  const double *low, *high;  ///< box that holds all of it, grown
  const double* inside;      ///< a point of it
  double margin;
};

/// Which of some balls may be near a hull: near[i] = 0 proves that ball i and the grown hull do not meet.
/// Eight balls at a time, by the search of apart.h, in at most so many steps.  @param count  of balls,
/// padded; the arrays too
void balls_near(const HullColumns& hull, Columns centres, const double* radii, int count, int steps,
                unsigned char* near);

/// The test of balls_near for one direction:
/// ball i is excluded where direction . centre - radius > limit.  Only clears entries of `near`.
void balls_beyond(const double direction[3], double limit, Columns centres, const double* radii, int count,
                  unsigned char* near);

}  // namespace palpate::proxy
