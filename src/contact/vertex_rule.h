#pragma once
#include <span>
#include <vector>

#include "contact/exact_lines.h"
#include "contact/facing.h"
#include "palpate/contact/sources.h"

namespace palpate::contact {

/// A sample before it knows its bodies: two triangles on a line along the normal, and what they stand for.
struct Hit {
  Facing at;
  std::uint32_t pixel;
  int face_a, face_b;  ///< of the patches' faces
  double area;         ///< projected [m^2]
};

/// Samples at the vertices of a region (Galoppo et al. 2007), once its image is there.
///
/// Each vertex of a patch is a point of its own body, opposite the other body's triangle on the line through
/// it; it stands for a third of the projected area of each adjacent triangle that is not turned away.  The
/// triangle opposite is the one that holds it among those that the image shows in the vertex's pixel and its
/// eight neighbours; where none of these does, where one has layers or walls, and without an image, an exact
/// line through the vertex finds it.  Of two soft bodies both have samples, each for half of its area: either
/// alone is a quadrature of the overlap, the mean favours none (a two-pass node-to-surface contact).
class VertexRule {
 public:
  struct Region {
    const Patch &a, &b;
    const ContactCamera& camera;
    FacePlanes &planes_a, &planes_b;
    double candidate_gap;
    bool lines_only;      ///< no image: a line through every vertex
    bool both_sides;      ///< else the vertices of a alone
    DepthReading depths;  ///< of which the second asks for an image
  };
  /// @param pairs  of the image, ascending by pixel  @param doubtful  pixels with layers or walls, ascending
  /// @param pixels  hits at the pixels: what depths are interpolated between; may be those of `out`
  void find(const Region& region, std::span<const FacePair> pairs, std::span<const std::uint32_t> doubtful,
            std::span<const Hit> pixels, ExactLines& lines, std::vector<Hit>& out);

 private:
  struct Vertex {
    double area = 0.0;
    int visible = -1;      ///< of the faces that it is a corner of, the one that is seen largest
    double largest = 0.0;  ///< that one's projected area
    int corner = 0;
  };
  void find_on_side(const Region& region, bool of_a, std::span<const FacePair> pairs, ExactLines& lines,
                    std::vector<Hit>& out);
  void collect(const Patch& patch, double side, double share);
  bool take(const Region& region, bool of_a, int vertex, int other, Hit& hit) const;
  enum class Opposite { kFound, kAskLine, kNone };
  Opposite look_up(const Region& region, bool of_a, int vertex, int column, int row,
                   std::span<const FacePair> pairs, int& other) const;
  bool is_doubtful(const ContactCamera& camera, int column, int row) const;
  bool interpolate(const Region& region, bool of_a, Hit& hit) const;

  std::vector<Vertex> vertices_;
  std::vector<Hit> hits_;
  std::vector<std::int32_t> pair_at_;  ///< by pixel: index into the pairs, -1: none
  std::vector<char> doubtful_;         ///< by pixel
  std::vector<double> gap_at_;         ///< by pixel [m]; NaN: none
  struct Asking {
    int vertex;
    std::uint32_t pixel;
  };
  std::vector<Asking> asking_;  ///< for a line
  std::vector<Eigen::Vector2d> points_;
  std::vector<FacePair> found_;
};

}  // namespace palpate::contact
