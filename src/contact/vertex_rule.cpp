#include "contact/vertex_rule.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

namespace palpate::contact {
namespace {

/// The pixel that holds a point; false where that is outside.
bool pixel_of(const ContactCamera& camera, double u, double v, int& column, int& row) {
  const double x = std::floor((u - camera.u0) / camera.pixel), y = std::floor((v - camera.v0) / camera.pixel);
  if (!(x >= 0.0 && y >= 0.0 && x < camera.width && y < camera.height)) return false;
  column = static_cast<int>(x);
  row = static_cast<int>(y);
  return true;
}

/// A vertex, moved into a face that it is a corner of by less than any edge that is seen: at the vertex
/// itself rounding says whether a line meets the face, and at the rim of a patch there is no other.
Eigen::Vector2d inside_of_face(const Patch& patch, int visible, Eigen::Index vertex) {
  constexpr double kMoved = 1e-9;  // of the way to the face's middle
  const auto corner = patch.faces->col(patch.visible[static_cast<std::size_t>(visible)]);
  const Eigen::Vector2d middle =
      (patch.uvw.col(corner[0]) + patch.uvw.col(corner[1]) + patch.uvw.col(corner[2])).head<2>() / 3.0;
  return (1.0 - kMoved) * patch.uvw.col(vertex).head<2>() + kMoved * middle;
}

}  // namespace

void VertexRule::find(const Region& region, std::span<const FacePair> pairs,
                      std::span<const std::uint32_t> doubtful, std::span<const Hit> pixels, ExactLines& lines,
                      std::vector<Hit>& out) {
  const auto size =
      static_cast<std::size_t>(region.camera.width) * static_cast<std::size_t>(region.camera.height);
  pair_at_.assign(size, -1);
  doubtful_.assign(size, 0);
  for (std::size_t i = 0; i < pairs.size(); ++i) pair_at_[pairs[i].at] = static_cast<std::int32_t>(i);
  for (const std::uint32_t pixel : doubtful) doubtful_[pixel] = 1;
  if (region.depths == DepthReading::kInterpolated) {
    gap_at_.assign(size, std::numeric_limits<double>::quiet_NaN());
    for (const Hit& hit : pixels) gap_at_[hit.pixel] = hit.at.gap();
  }
  hits_.clear();
  find_on_side(region, true, pairs, lines, hits_);
  if (region.both_sides) find_on_side(region, false, pairs, lines, hits_);
  out.swap(hits_);
}

void VertexRule::collect(const Patch& patch, double side, double share) {
  vertices_.assign(static_cast<std::size_t>(patch.uvw.cols()), {});
  for (std::size_t i = 0; i < patch.visible.size(); ++i) {
    const auto corner = patch.faces->col(patch.visible[i]);
    const auto p = [&](int k) { return patch.uvw.col(corner[k]).head<2>(); };
    const Eigen::Vector2d e = p(1) - p(0), f = p(2) - p(0);
    const double area = 0.5 * side * (e.x() * f.y() - e.y() * f.x());
    if (!(area > 0.0)) continue;  // turned away
    for (int k = 0; k < 3; ++k) {
      Vertex& vertex = vertices_[static_cast<std::size_t>(corner[k])];
      vertex.area += share * area / 3.0;
      // On a wall that rounding turns this way, the weights would be a quotient of two roundings.
      if (area <= vertex.largest) continue;
      vertex.largest = area;
      vertex.visible = static_cast<int>(i);
      vertex.corner = k;
    }
  }
}

void VertexRule::find_on_side(const Region& region, bool of_a, std::span<const FacePair> pairs,
                              ExactLines& lines, std::vector<Hit>& out) {
  const Patch& own = of_a ? region.a : region.b;
  collect(own, of_a ? -1.0 : 1.0, region.both_sides ? 0.5 : 1.0);
  const std::size_t first = out.size();
  asking_.clear();
  points_.clear();
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    if (vertices_[i].visible < 0) continue;
    const auto vertex = static_cast<Eigen::Index>(i);
    const double u = own.uvw(0, vertex), v = own.uvw(1, vertex);
    int column = 0, row = 0;
    if (!pixel_of(region.camera, u, v, column, row)) continue;
    const auto pixel = static_cast<std::uint32_t>(row * region.camera.width + column);
    Hit hit;
    hit.pixel = pixel;
    int other = -1;
    const Opposite opposite = region.lines_only || is_doubtful(region.camera, column, row)
                                  ? Opposite::kAskLine
                                  : look_up(region, of_a, static_cast<int>(i), column, row, pairs, other);
    if (opposite == Opposite::kAskLine) {
      asking_.push_back({static_cast<int>(i), pixel});
      points_.push_back(inside_of_face(own, vertices_[i].visible, vertex));
    } else if (opposite == Opposite::kFound && take(region, of_a, static_cast<int>(i), other, hit)) {
      out.push_back(hit);
    }
  }
  // A line meets all layers; the vertex's own is the one that starts at the vertex.
  lines.through(points_, region.a, region.b, region.camera, region.candidate_gap, found_);
  const double same = 1e-9 * (region.camera.far - region.camera.near);
  for (const FacePair& pair : found_) {
    const auto [vertex, pixel] = asking_[pair.at];
    const auto at = own.uvw.col(vertex).head<2>();
    Hit hit;
    hit.pixel = pixel;
    Vec3 weights;
    double w;
    FacePlanes& planes = of_a ? region.planes_a : region.planes_b;
    if (!planes.at(static_cast<int>(of_a ? pair.a : pair.b), at.x(), at.y(), weights, w)) continue;
    if (std::abs(w - own.uvw(2, vertex)) > same) continue;
    if (take(region, of_a, vertex, static_cast<int>(of_a ? pair.b : pair.a), hit)) out.push_back(hit);
  }
  // neighbours in the plane stand one behind the other, whichever way they were found
  std::sort(out.begin() + static_cast<std::ptrdiff_t>(first), out.end(), [](const Hit& p, const Hit& q) {
    return std::tie(p.pixel, p.at.u, p.at.v, p.at.w_a, p.at.w_b) <
           std::tie(q.pixel, q.at.u, q.at.v, q.at.w_a, q.at.w_b);
  });
}

/// Fills a hit of the vertex and the other body's triangle `other` (index into its `visible`), but for the
/// pixel.  False where they are farther apart than the candidate gap.
bool VertexRule::take(const Region& region, bool of_a, int vertex, int other, Hit& hit) const {
  const Patch &own = of_a ? region.a : region.b, &opposite = of_a ? region.b : region.a;
  const Vertex& v = vertices_[static_cast<std::size_t>(vertex)];
  const Vec3 x = own.uvw.col(vertex);
  Facing& at = hit.at;
  at.u = x.x();
  at.v = x.y();
  FacePlanes& planes = of_a ? region.planes_b : region.planes_a;
  if (!planes.at(other, at.u, at.v, of_a ? at.weights_b : at.weights_a, of_a ? at.w_b : at.w_a)) return false;
  (of_a ? at.w_a : at.w_b) = x.z();
  (of_a ? at.weights_a : at.weights_b) = Vec3::Unit(v.corner);
  const int own_face = own.visible[static_cast<std::size_t>(v.visible)],
            other_face = opposite.visible[static_cast<std::size_t>(other)];
  hit.face_a = of_a ? own_face : other_face;
  hit.face_b = of_a ? other_face : own_face;
  hit.area = v.area;
  if (region.depths == DepthReading::kInterpolated && !interpolate(region, of_a, hit)) return false;
  return at.gap() < region.candidate_gap;
}

/// Whether a pixel or one of its neighbours has layers or walls.
bool VertexRule::is_doubtful(const ContactCamera& camera, int column, int row) const {
  for (int y = std::max(0, row - 1); y <= std::min(camera.height - 1, row + 1); ++y)
    for (int x = std::max(0, column - 1); x <= std::min(camera.width - 1, column + 1); ++x)
      if (doubtful_[static_cast<std::size_t>(y * camera.width + x)]) return true;
  return false;
}

/// The triangle that holds the vertex, among those that the image shows around it.  Where it shows others
/// alone (triangles smaller than pixels, a rim), a line has to tell; where it shows none, nothing is near.
VertexRule::Opposite VertexRule::look_up(const Region& region, bool of_a, int vertex, int column, int row,
                                         std::span<const FacePair> pairs, int& other) const {
  static constexpr std::array<std::array<int, 2>, 9> kAround = {
      {{0, 0}, {-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}}};
  constexpr double kOnEdge = -1e-12;
  const Patch& own = of_a ? region.a : region.b;
  FacePlanes& planes = of_a ? region.planes_b : region.planes_a;
  const ContactCamera& camera = region.camera;
  Opposite found = Opposite::kNone;
  for (const auto& [right, up] : kAround) {
    const int x = column + right, y = row + up;
    if (x < 0 || y < 0 || x >= camera.width || y >= camera.height) continue;
    const std::int32_t pair = pair_at_[static_cast<std::size_t>(y * camera.width + x)];
    if (pair < 0) continue;
    found = Opposite::kAskLine;
    const FacePair& faces = pairs[static_cast<std::size_t>(pair)];
    other = static_cast<int>(of_a ? faces.b : faces.a);
    Vec3 weights;
    double w;
    if (planes.at(other, own.uvw(0, vertex), own.uvw(1, vertex), weights, w) && weights.minCoeff() >= kOnEdge)
      return Opposite::kFound;
  }
  return found;
}

// The difference of the two images between the middles of four pixels, bilinear: for a smooth gap g with
// pixels of edge h the error is at most h^2/8 (|g_uu| + |g_vv|).  Where some of the four show nothing, the
// others' weights are divided by their sum, which costs an order, at the patch's border.  The opposite point
// is moved along the normal by what is read more or less than its triangle has.
bool VertexRule::interpolate(const Region& region, bool of_a, Hit& hit) const {
  const ContactCamera& camera = region.camera;
  const double x = (hit.at.u - camera.u0) / camera.pixel - 0.5,
               y = (hit.at.v - camera.v0) / camera.pixel - 0.5;
  const double column = std::floor(x), row = std::floor(y);
  double sum = 0.0, weight = 0.0;
  for (int i = 0; i < 4; ++i) {
    const double right = i % 2, up = i / 2;
    const double c = column + right, r = row + up;
    if (!(c >= 0.0 && r >= 0.0 && c < camera.width && r < camera.height)) continue;
    const double gap = gap_at_[static_cast<std::size_t>(r) * static_cast<std::size_t>(camera.width) +
                               static_cast<std::size_t>(c)];
    if (std::isnan(gap)) continue;
    const double share = (1.0 - std::abs(x - c)) * (1.0 - std::abs(y - r));
    sum += share * gap;
    weight += share;
  }
  if (!(weight > 0.0)) return false;
  const double more = sum / weight - hit.at.gap();
  (of_a ? hit.at.w_b : hit.at.w_a) += of_a ? -more : more;
  return true;
}

}  // namespace palpate::contact
