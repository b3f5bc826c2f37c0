#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <unordered_map>

#include "contour.h"
#include "palpate/core/error.h"

// Each cube of the lattice is cut into six tetrahedra around its diagonal (Kuhn 1960): a tetrahedron goes
// from the low corner to the high one along the three axes in one of their six orders.  The cut is the same
// in every cube, so faces match, and a plane of the lattice is a union of faces: a symmetric body may be cut
// there.  The surface crosses an edge where the function changes sign; a tetrahedron holds one triangle or
// two.  A block of cubes is skipped where |inside(centre)| exceeds the Lipschitz bound times its half
// diagonal.  The bound is an estimate of the shape's author: fine relief may be steeper in places, and a
// block skipped there would leave a hole. Therefore a skipped block is marched if the surface leaves a
// marched block through their common side, so that every piece found by the sweep is complete and closed.
namespace palpate::shapes {
namespace {

constexpr int kBlock = 6;  // cubes along the edge of a block
constexpr int kOrders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
using Place = std::array<int, 3>;

class March {
 public:
  explicit March(const Blueprint& blueprint)
      : blueprint_(blueprint), low_(blueprint.low), h_(blueprint.lattice) {
    if (blueprint.symmetric) low_.x() = 0.0;
    for (int a = 0; a < 3; ++a)
      blocks_[static_cast<std::size_t>(a)] =
          static_cast<int>(std::ceil((blueprint.high[a] - low_[a]) / (h_ * kBlock)));
  }

  TriMesh run() {
    const double reach = blueprint_.lipschitz * 0.5 * kBlock * h_ * std::sqrt(3.0);
    for (int i = 0; i < blocks_[0]; ++i)
      for (int j = 0; j < blocks_[1]; ++j)
        for (int k = 0; k < blocks_[2]; ++k) {
          const Vec3 centre = at(first_of({i, j, k})) + Vec3::Constant(0.5 * kBlock * h_);
          if (std::abs(blueprint_.inside(centre)) <= reach) block({i, j, k});
        }
    for (std::size_t next = 0; next < crossed_.size(); ++next) block(crossed_[next]);
    TriMesh mesh;
    mesh.vertices.resize(3, static_cast<Eigen::Index>(points_.size()));
    for (std::size_t p = 0; p < points_.size(); ++p)
      mesh.vertices.col(static_cast<Eigen::Index>(p)) = points_[p];
    mesh.faces.resize(3, static_cast<Eigen::Index>(faces_.size()));
    for (std::size_t f = 0; f < faces_.size(); ++f)
      mesh.faces.col(static_cast<Eigen::Index>(f)) =
          Eigen::Vector3i(faces_[f][0], faces_[f][1], faces_[f][2]);
    return mesh;
  }

 private:
  Vec3 at(const Place& p) const { return low_ + h_ * Vec3(p[0], p[1], p[2]); }
  static int local(int a, int b, int c) { return (a * (kBlock + 1) + b) * (kBlock + 1) + c; }

  static Place first_of(const Place& block) {
    return {block[0] * kBlock, block[1] * kBlock, block[2] * kBlock};
  }
  bool in_lattice(const Place& block) const {
    for (std::size_t a = 0; a < 3; ++a)
      if (block[a] < 0 || block[a] >= blocks_[a]) return false;
    return true;
  }

  /// Whether the function changes its sign on the side of the block where coordinate `axis` is `at`.
  bool crosses_side(int axis, int at) const {
    bool some_in = false, some_out = false;
    for (int u = 0; u <= kBlock; ++u)
      for (int v = 0; v <= kBlock; ++v) {
        const int n = axis == 0 ? local(at, u, v) : axis == 1 ? local(u, at, v) : local(u, v, at);
        (values_[static_cast<std::size_t>(n)] < 0 ? some_in : some_out) = true;
      }
    return some_in && some_out;
  }

  void block(Place where) {
    if (!marched_.insert(where).second) return;
    const Place first = first_of(where);
    bool some_in = false, some_out = false;
    for (int a = 0; a <= kBlock; ++a)
      for (int b = 0; b <= kBlock; ++b)
        for (int c = 0; c <= kBlock; ++c) {
          const double f = values_[static_cast<std::size_t>(local(a, b, c))] =
              blueprint_.inside(at({first[0] + a, first[1] + b, first[2] + c}));
          (f < 0 ? some_in : some_out) = true;
        }
    if (!some_in || !some_out) return;
    for (int axis = 0; axis < 3; ++axis)
      for (const int side : {-1, 1}) {
        Place neighbour = where;
        neighbour[static_cast<std::size_t>(axis)] += side;
        if (in_lattice(neighbour) && crosses_side(axis, side < 0 ? 0 : kBlock)) crossed_.push_back(neighbour);
      }
    for (int a = 0; a < kBlock; ++a)
      for (int b = 0; b < kBlock; ++b)
        for (int c = 0; c < kBlock; ++c)
          for (const auto& order : kOrders) tetrahedron(first, {a, b, c}, order);
  }

  void tetrahedron(const Place& first, const Place& cube, const int (&order)[3]) {
    std::array<Place, 4> corner;
    std::array<double, 4> value;
    Place p = cube;
    for (int n = 0; n < 4; ++n) {
      if (n > 0) ++p[static_cast<std::size_t>(order[n - 1])];
      corner[static_cast<std::size_t>(n)] = {first[0] + p[0], first[1] + p[1], first[2] + p[2]};
      value[static_cast<std::size_t>(n)] = values_[static_cast<std::size_t>(local(p[0], p[1], p[2]))];
    }
    std::array<int, 4> in{}, out{};
    int ins = 0, outs = 0;
    for (int n = 0; n < 4; ++n)
      (value[static_cast<std::size_t>(n)] < 0 ? in[static_cast<std::size_t>(ins++)]
                                              : out[static_cast<std::size_t>(outs++)]) = n;
    if (ins == 0 || outs == 0) return;
    const auto vertex = [&](int i, int o) {
      const auto a = static_cast<std::size_t>(in[static_cast<std::size_t>(i)]),
                 b = static_cast<std::size_t>(out[static_cast<std::size_t>(o)]);
      return crossing(corner[a], corner[b], value[a], value[b]);
    };
    // Outwards: from the mean of the corners inside to the mean of the corners outside.  The orientation is
    // judged at the midpoints of the edges, where no triangle is thin.
    Vec3 outwards = Vec3::Zero();
    for (int i = 0; i < ins; ++i)
      outwards -= place(corner[static_cast<std::size_t>(in[static_cast<std::size_t>(i)])]) / ins;
    for (int o = 0; o < outs; ++o)
      outwards += place(corner[static_cast<std::size_t>(out[static_cast<std::size_t>(o)])]) / outs;
    const auto middle = [&](int i, int o) {
      return Vec3(0.5 * (place(corner[static_cast<std::size_t>(in[static_cast<std::size_t>(i)])]) +
                         place(corner[static_cast<std::size_t>(out[static_cast<std::size_t>(o)])])));
    };
    using Edge = std::array<int, 2>;
    const auto emit = [&](Edge a, Edge b, Edge c) {
      const Vec3 normal =
          (middle(b[0], b[1]) - middle(a[0], a[1])).cross(middle(c[0], c[1]) - middle(a[0], a[1]));
      if (normal.dot(outwards) < 0) std::swap(b, c);
      faces_.push_back({vertex(a[0], a[1]), vertex(b[0], b[1]), vertex(c[0], c[1])});
    };
    if (ins == 1)
      emit({0, 0}, {0, 1}, {0, 2});
    else if (outs == 1)
      emit({0, 0}, {1, 0}, {2, 0});
    else
      emit({0, 0}, {0, 1}, {1, 1}), emit({0, 0}, {1, 1}, {1, 0});
  }

  static Vec3 place(const Place& p) { return {double(p[0]), double(p[1]), double(p[2])}; }

  /// Returns the vertex on an edge of the lattice, created on first use.  It is kept away from the edge's
  /// ends, because crossings that crowd around a lattice point make slivers.
  int crossing(Place a, Place b, double fa, double fb) {
    if (b < a) std::swap(a, b), std::swap(fa, fb);
    const auto way = static_cast<std::uint64_t>((b[0] - a[0]) * 4 + (b[1] - a[1]) * 2 + (b[2] - a[2]));
    const std::uint64_t key =
        ((static_cast<std::uint64_t>(a[0]) << 20 | static_cast<std::uint64_t>(a[1])) << 20 |
         static_cast<std::uint64_t>(a[2]))
            << 3 |
        way;
    const auto [entry, fresh] = vertex_.try_emplace(key, static_cast<int>(points_.size()));
    if (fresh) points_.push_back(at(a) + std::clamp(fa / (fa - fb), 0.15, 0.85) * (at(b) - at(a)));
    return entry->second;
  }

  const Blueprint& blueprint_;
  Vec3 low_;
  double h_;
  std::array<int, 3> blocks_{};
  std::set<Place> marched_;
  std::vector<Place> crossed_;  ///< blocks behind a side that the surface crosses
  std::array<double, (kBlock + 1) * (kBlock + 1) * (kBlock + 1)> values_{};
  std::unordered_map<std::uint64_t, int> vertex_;
  std::vector<Vec3> points_;
  std::vector<std::array<int, 3>> faces_;
};

}  // namespace

TriMesh march(const Blueprint& blueprint) {
  PALPATE_CHECK(blueprint.lattice > 0 && blueprint.inside, "lattice = {}", blueprint.lattice);
  return March(blueprint).run();
}

}  // namespace palpate::shapes
