#pragma once
#include <optional>
#include <vector>

#include "palpate/contact/sample.h"
#include "palpate/mesh/mesh.h"

/// Depth fields in double precision, against which images are measured.  Nothing of the library's own images
/// is used.
namespace palpate::validation {

/// Where samples of one image stand: the middles of square pixels in a plane across the normal.
struct PixelGrid {
  Mat3 axes = Mat3::Identity();  ///< columns u, v, n
  Vec3 origin = Vec3::Zero();    ///< the middle of pixel (0, 0); its n is nothing
  double pixel = 0.0;            ///< edge [m]
  int width = 0, height = 0;
  Vec3 middle(int column, int row) const { return origin + axes * Vec3(column * pixel, row * pixel, 0.0); }
};

/// One pixel of both surfaces along n.
struct DepthPixel {
  bool covered = false;
  double gap = 0.0;  ///< n . (lowest point of a - highest of b) [m]; depth is -gap
};

/// Where a sample's points are, of a source whose side a hangs on the nodes `nodes` and whose side b does
/// not move.
struct SampleAt {
  Vec3 a, b;
};
SampleAt sample_at(const contact::ContactSample& sample, const Points& nodes);

/// The grid that these samples stand on, with `margin` pixels around them.  @pre samples of one image
PixelGrid grid_of(const std::vector<contact::ContactSample>& samples, const Points& nodes, int margin);
/// Column and row of a point.
struct Cell {
  int column, row;
};
Cell cell_of(const PixelGrid& grid, const Vec3& point);

/// A line along n through each pixel's middle, cut with every triangle: of a (seen from below) the lowest
/// crossing, of b (seen from above) the highest.
std::vector<DepthPixel> cast(const PixelGrid& grid, const TriMesh& a, const TriMesh& b);

/// How an image's field differs from the reference.
struct FieldError {
  double inside = 0.0;  ///< largest error of a depth where both overlap [m]
  int missed = 0;       ///< overlapping pixels without a sample, more than a pixel inside the silhouette
  int extra = 0;        ///< samples that overlap, more than a pixel outside the silhouette
  int compared = 0;     ///< overlapping pixels in both
};
FieldError compare_fields(const std::vector<contact::ContactSample>& samples, const TriMesh& a,
                          const TriMesh& b);

}  // namespace palpate::validation
