#include <algorithm>
#include <cmath>

#include "contact/depth_image.h"
#include "palpate/core/counters.h"

// No image at all: a line along the normal through the middle of each pixel, cut with every triangle that its
// pixel may see, in double precision.
//
// Along the line, upwards, body a is entered where it faces down, body b is left where it faces up.  These
// crossings, sorted by height, form runs A..A B..B A..A ...  A run of A with the run of B above it is an
// overlap: from its lowest A to its highest B.  A run of B with the run of A above it is a gap.  Of a height
// field along the normal there is one of either, and the image of the lowest A and the highest B is the same;
// teeth and overhangs have layers, each with a pair of its own.

namespace palpate::contact {
namespace {

struct Crossing {
  std::uint32_t pixel;
  std::uint32_t face;  ///< index into `visible`
  double w;
  bool of_a;
};

bool before(const Crossing& p, const Crossing& q) {
  return p.pixel != q.pixel ? p.pixel < q.pixel : p.w < q.w;
}

/// Twice the area of p, q and the point, from the corner with the lower number, so that two triangles with a
/// common edge never both miss a point on it.
double side(const Vec3& p, const Vec3& q, bool swapped, double x, double y) {
  const Vec3 &from = swapped ? q : p, &to = swapped ? p : q;
  const double e = (to.x() - from.x()) * (y - from.y()) - (to.y() - from.y()) * (x - from.x());
  return swapped ? -e : e;
}

class ExactImage final : public DepthImage {
 public:
  ExactImage() { counters::count("contact.exact_image"); }

  void find_pairs(const Patch& a, const Patch& b, const ContactCamera& camera, double candidate_gap,
                  std::vector<PixelPair>& pairs) override {
    pairs.clear();
    if (!camera.sees_something()) return;
    crossings_.clear();
    cut(a, camera, true);
    cut(b, camera, false);
    std::sort(crossings_.begin(), crossings_.end(), before);
    for (std::size_t first = 0, last = 0; first < crossings_.size(); first = last) {
      while (last < crossings_.size() && crossings_[last].pixel == crossings_[first].pixel) ++last;
      pair_layers(first, last, candidate_gap, pairs);
    }
  }

 private:
  void cut(const Patch& patch, const ContactCamera& camera, bool of_a) {
    for (std::size_t f = 0; f < patch.visible.size(); ++f) {
      const auto corner = patch.faces->col(patch.visible[f]);
      const Vec3 p[3] = {patch.uvw.col(corner[0]), patch.uvw.col(corner[1]), patch.uvw.col(corner[2])};
      const double area =
          (p[1].x() - p[0].x()) * (p[2].y() - p[0].y()) - (p[2].x() - p[0].x()) * (p[1].y() - p[0].y());
      if (of_a ? !(area < 0.0) : !(area > 0.0)) continue;  // turned away
      const auto index = [&](double x, double x0) { return (x - x0) / camera.pixel - 0.5; };
      const auto [low_x, high_x] = std::minmax({p[0].x(), p[1].x(), p[2].x()});
      const auto [low_y, high_y] = std::minmax({p[0].y(), p[1].y(), p[2].y()});
      const int first_x = std::max(0, static_cast<int>(std::floor(index(low_x, camera.u0)))),
                last_x = std::min(camera.width - 1, static_cast<int>(std::ceil(index(high_x, camera.u0)))),
                first_y = std::max(0, static_cast<int>(std::floor(index(low_y, camera.v0)))),
                last_y = std::min(camera.height - 1, static_cast<int>(std::ceil(index(high_y, camera.v0))));
      const double turn = area > 0.0 ? 1.0 : -1.0;
      for (int row = first_y; row <= last_y; ++row)
        for (int column = first_x; column <= last_x; ++column) {
          const double x = camera.u(column), y = camera.v(row);
          const double e0 = turn * side(p[1], p[2], corner[1] > corner[2], x, y),
                       e1 = turn * side(p[2], p[0], corner[2] > corner[0], x, y),
                       e2 = turn * side(p[0], p[1], corner[0] > corner[1], x, y);
          if (e0 < 0.0 || e1 < 0.0 || e2 < 0.0) continue;
          const double w = (e0 * p[0].z() + e1 * p[1].z() + e2 * p[2].z()) / (e0 + e1 + e2);
          crossings_.push_back({static_cast<std::uint32_t>(row * camera.width + column),
                                static_cast<std::uint32_t>(f), w, of_a});
        }
    }
  }

  /// @param first, last  crossings of one pixel, by height
  void pair_layers(std::size_t first, std::size_t last, double candidate_gap, std::vector<PixelPair>& pairs) {
    std::size_t run = first;  // where the present run starts
    for (std::size_t i = first + 1, previous = last; i <= last; ++i) {
      if (i < last && crossings_[i].of_a == crossings_[run].of_a) continue;
      // `run` .. i - 1 are of one body; the run before it starts at `previous`
      if (previous != last) {
        const bool overlap = !crossings_[run].of_a;  // an A below a B
        const Crossing& lower = crossings_[overlap ? previous : run - 1];
        const Crossing& upper = crossings_[overlap ? i - 1 : run];
        if (overlap)
          pairs.push_back({lower.pixel, lower.face, upper.face});
        else if (upper.w - lower.w < candidate_gap)
          pairs.push_back({lower.pixel, upper.face, lower.face});
      }
      previous = run;
      run = i;
    }
  }

  std::vector<Crossing> crossings_;
};

}  // namespace

std::unique_ptr<DepthImage> make_exact_image() { return std::make_unique<ExactImage>(); }

}  // namespace palpate::contact
