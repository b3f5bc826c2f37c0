#pragma once
#include "palpate/mesh/mesh.h"

/// Two corrugated plates, one over the other, that overlap in islands.
///
/// The top of the lower one is z = a sin(q x). The bottom of the upper one is the same surface, moved by x0
/// along x and h along z, on a keel: z = h + a sin(q (x - x0)) + s |y|. The depth is
///     A cos(q (x - x0/2)) - h - s |y|,     A = 2 a sin(q x0/2),
/// zero along the border of each island (no walls). With cos(f) = h/A, an island has
///     across x at the keel's height h', f' = arccos(h'/A):
///         section (2/q) (A sin f' - h' f'),  width 2 f'/q,
/// and integrated over y, dh' = s dy:
///     volume = (4 A^2/(s q)) (f/2 + f cos(2 f)/4 - 3 sin(2 f)/8),
///     area   = (4 A/(s q)) (sin f - f cos f).
namespace palpate::validation {

struct Plates {
  double amplitude = 0.02, wavelength = 0.5, slope = 0.08;
  int cells = 40;                         ///< Per wavelength; a multiple of 10.
  static constexpr int kIslands = 3;      ///< For x0 from 0.1 to 0.5 wavelengths and |h| < A/2.
  static constexpr double kLength = 3.3;  ///< Length of a plate [wavelengths].
  static constexpr double kWidth = 1.3;   ///< [m]
  static constexpr double kThickness = 0.3;

  double wave_number() const;
  double overlap_amplitude(double x0) const;  ///< A
  double volume(double x0, double h) const;   ///< Volume of all islands [m^3].
  double area(double x0, double h) const;
  /// Returns the volume of the facets' overlap, for x0 a whole number of cells, so that vertices face
  /// vertices: the depth at the keel is a polygon d(x), the volume the integral of d+^2/s, the area the
  /// integral of 2 d+/s.
  double facet_volume(double x0, double h) const;
  double facet_area(double x0, double h) const;

  TriMesh lower() const;
  TriMesh upper(double x0, double h) const;

 private:
  template <class Segment>
  double over_facets(double x0, double h, Segment integral) const;
};

}  // namespace palpate::validation
