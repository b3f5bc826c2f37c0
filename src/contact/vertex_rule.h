#pragma once
#include <span>
#include <vector>

#include "contact/depth_image.h"
#include "contact/facing.h"

namespace palpate::contact {

/// A sample before it knows its bodies: a vertex, the triangle opposite, and what they stand for.
struct Hit {
  Facing at;
  int face_a, face_b;  ///< of the patches' faces
  double area;         ///< projected [m^2]
};

/// Gathers a region's image at the vertices (Galoppo et al. 2007).
///
/// Each vertex of a patch that the image shows is a point of its own body, opposite the other body's triangle
/// on the line through it; it stands for a third of the projected area of each adjacent triangle that is not
/// turned away.  The triangle opposite is the one that holds it among those that the image shows in the
/// vertex's pixel and its eight neighbours, or else the one that it is least outside of.  Of two soft bodies
/// both have samples, each for half of its area: either alone is a quadrature of the overlap, the mean
/// favours none (a two-pass node-to-surface contact).
class VertexRule {
 public:
  struct Region {
    const Patch &a, &b;
    const ContactCamera& camera;
    FacePlanes &planes_a, &planes_b;
    double candidate_gap;
    bool both_sides;  ///< else the vertices of a alone
  };
  /// @param pairs  of the image, ascending by pixel
  void find(const Region& region, std::span<const FacePair> pairs, std::vector<Hit>& out);

 private:
  struct Vertex {
    double area = 0.0;
    int visible = -1;      ///< of the faces that it is a corner of, the one that is seen largest
    double largest = 0.0;  ///< that one's projected area
    int corner = 0;
  };
  void find_on_side(const Region& region, bool of_a, std::span<const FacePair> pairs, std::vector<Hit>& out);
  void collect(const Patch& patch, double side, double share);
  int opposite(const Region& region, bool of_a, int vertex, std::span<const FacePair> pairs) const;

  std::vector<Vertex> vertices_;
  std::vector<std::int32_t> pair_at_;  ///< by pixel: index into the pairs, -1: none
};

}  // namespace palpate::contact
