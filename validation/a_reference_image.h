#pragma once
#include <optional>
#include <vector>

#include "palpate/contact/sample.h"
#include "palpate/mesh/mesh.h"

/// Reference depth fields in double precision, independent of the library's image code.
namespace palpate::validation {

/// Sampling positions of one image: centres of square pixels in a plane across the normal.
struct PixelGrid {
  Mat3 axes = Mat3::Identity();  ///< Columns u, v, n.
  Vec3 origin = Vec3::Zero();    ///< Centre of pixel (0, 0); its component along n has no meaning.
  double pixel = 0.0;            ///< Edge length [m].
  int width = 0, height = 0;
  Vec3 middle(int column, int row) const { return origin + axes * Vec3(column * pixel, row * pixel, 0.0); }
};

/// Depth of both surfaces along n at one pixel.
struct DepthPixel {
  bool covered = false;
  double gap = 0.0;  ///< n . (lowest point of a - highest point of b) [m]; depth = -gap.
};

/// World positions of a sample's two points, for a source whose side a follows the nodes `nodes` and whose
/// side b is fixed.
struct SampleAt {
  Vec3 a, b;
};
SampleAt sample_at(const contact::ContactSample& sample, const Points& nodes);

/// Returns the pixel grid of the given samples, extended by `margin` pixels on each side.  @pre samples of
/// one image
PixelGrid grid_of(const std::vector<contact::ContactSample>& samples, const Points& nodes, int margin);
/// Column and row of a pixel.
struct Cell {
  int column, row;
};
Cell cell_of(const PixelGrid& grid, const Vec3& point);

/// Intersects the line along n through each pixel centre with every triangle. For a (seen from below) the
/// lowest crossing counts, for b (seen from above) the highest.
std::vector<DepthPixel> cast(const PixelGrid& grid, const TriMesh& a, const TriMesh& b);

/// Difference between the field of an image and the reference.
struct FieldError {
  double inside = 0.0;  ///< Largest depth error where both overlap [m].
  int missed = 0;       ///< Overlapping pixels without a sample, more than a pixel inside the silhouette.
  int extra = 0;        ///< Overlapping samples more than a pixel outside the silhouette.
  int compared = 0;     ///< Pixels that overlap in both.
};
FieldError compare_fields(const std::vector<contact::ContactSample>& samples, const TriMesh& a,
                          const TriMesh& b);

}  // namespace palpate::validation
