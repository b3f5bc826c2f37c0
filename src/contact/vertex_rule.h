#pragma once
#include <span>
#include <vector>

#include "contact/depth_image.h"
#include "contact/triangle_pair_gap.h"

namespace palpate::contact {

/// Sample before it is assigned to bodies: a vertex, the triangle opposite, and the area that it represents.
struct Hit {
  TrianglePairGap at;
  int face_a, face_b;  ///< Faces of the patches.
  double area;         ///< Projected area [m^2].
};

/// Evaluates a region's image at the vertices (Galoppo et al. 2007).
///
/// Each vertex of a patch that the image shows is a contact point of its body, opposite to the other body's
/// triangle on the line through it. It represents a third of the projected area of each adjacent triangle
/// that is not turned away. The triangle opposite is, among those that the image shows in the vertex' pixel
/// and its eight neighbours, the one that contains it, or else the one that it is least outside of. If both
/// bodies are soft, both have samples, each for half of its area: either set is a quadrature of the overlap,
/// and the mean favours neither (a two-pass node-to-surface contact).
class VertexRule {
 public:
  /// Input of find(): patches, camera and triangles of one region.
  struct Region {
    const Patch &a, &b;
    const ContactCamera& camera;
    FacePlanes &planes_a, &planes_b;
    double candidate_gap;
    bool both_sides;  ///< True: vertices of both sides. False: vertices of a only.
  };
  /// Appends the samples of a region to the cleared `out`. @param pairs  pairs of the image, ascending by
  /// pixel
  void find(const Region& region, std::span<const FacePair> pairs, std::vector<Hit>& out);

 private:
  struct Vertex {
    double area = 0.0;
    int visible = -1;      ///< Largest visible adjacent face: index into `visible`.
    double largest = 0.0;  ///< Projected area of that face [m^2].
    int corner = 0;
  };
  void find_on_side(const Region& region, bool of_a, std::span<const FacePair> pairs, std::vector<Hit>& out);
  void collect(const Patch& patch, double side, double share);
  int opposite(const Region& region, bool of_a, int vertex, std::span<const FacePair> pairs) const;

  std::vector<Vertex> vertices_;
  std::vector<std::int32_t> pair_at_;  ///< Per pixel: index into the pairs, -1: none.
};

}  // namespace palpate::contact
