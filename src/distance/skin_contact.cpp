#include "distance/skin_contact.h"

#include <algorithm>
#include <cmath>

#include "distance/linear_gap.h"
#include "distance/skin_contact_impl.h"
#include "palpate/core/error.h"

namespace palpate::distance {

namespace {

std::array<ContactMesh, 2> meshes_of(const Skin& a, const Skin& b, const SkinContactSpec& spec) {
  std::array<ContactMesh, 2> out{contact_mesh(a, spec.spacing_m[0]), {}};
  if (spec.two_sided) out[1] = contact_mesh(b, spec.spacing_m[1]);
  return out;
}

}  // namespace

SkinContact::SkinContact(const Skin& a, const Skin& b, const SkinContactSpec& spec)
    : SkinContact(a, b, spec.stiffness_pa_m, meshes_of(a, b, spec)) {}

SkinContact::SkinContact(const Skin& a, const Skin& b, double stiffness, std::array<ContactMesh, 2> meshes)
    : SkinContact(a, b, stiffness, std::move(meshes), std::nullopt) {}

SkinContact::SkinContact(const Skin& skin, double stiffness, ContactMesh mesh, OwnContact own)
    : SkinContact(skin, skin, stiffness, {std::move(mesh), {}}, std::move(own)) {}

SkinContact::SkinContact(const Skin& a, const Skin& b, double stiffness, std::array<ContactMesh, 2> meshes,
                         std::optional<OwnContact> own)
    : own_(std::move(own)),
      stiffness_(!own_ && (meshes[0].points.empty() || meshes[1].points.empty()) ? stiffness
                                                                                 : 0.5 * stiffness),
      surfaces_{Surface(a), Surface(b)},
      meshes_(std::move(meshes)) {
  if (!(stiffness > 0.0)) fail("contact stiffness = {} Pa/m must be positive", stiffness);
  std::size_t count = 0, triangles = 0, clusters_in_all = 0;
  for (int side = 0; side < 2; ++side) {
    const Skin& skin = surfaces_[side].skin();
    const auto clusters = static_cast<std::size_t>(skin.cluster_count());
    const ContactMesh& mesh = meshes_[static_cast<std::size_t>(side)];
    for (const ContactTriangle& t : mesh.triangles)
      most_lowered_[side] = std::max(most_lowered_[side], t.lowered);
    cluster_points_[side].assign(clusters + 1, 0);
    for (const ContactPoint& p : points(side))
      ++cluster_points_[side][static_cast<std::size_t>(p.face / kClusterFaces) + 1];
    first_packet_[side] = {0};
    for (std::size_t c = 1; c <= clusters; ++c) {
      const int packets = (cluster_points_[side][c] + kPacket - 1) / kPacket;
      most_packets_ = std::max(most_packets_, static_cast<std::size_t>(packets));
      first_packet_[side].push_back(first_packet_[side].back() + packets);
      cluster_points_[side][c] += cluster_points_[side][c - 1];
    }
    std::array<int, kPacket> none;
    none.fill(-1);
    feet_[side].assign(static_cast<std::size_t>(first_packet_[side].back()), none);
    starts_[side].assign(clusters, -1);
    clear_[side].assign(clusters, -1.0);
    where_[side].assign(clusters, SideOfSurface::kOutside);
    whole_.reserve(std::max(whole_.capacity(), clusters));
    joined_.reserve(whole_.capacity());
    packets_clear_[side].assign(static_cast<std::size_t>(first_packet_[side].back()), -1.0);
    clusters_in_all = std::max(clusters_in_all, clusters);
    count += points(side).size();
    triangles += mesh.triangles.size();
    spring_of_[side].assign(points(side).size(), -1);
    is_near_[side].assign(mesh.triangles.size(), 0);
    VertexForces& at = vertex_forces_[side];
    at.sum.setZero(3, skin.vertex_count());
    at.is_touched.assign(static_cast<std::size_t>(skin.vertex_count()), 0);
    at.touched.reserve(static_cast<std::size_t>(skin.vertex_count()));
  }
  springs_.reserve(count);
  added_.reserve(count);
  triangles_.reserve(triangles);
  missing_.reserve(3 * triangles);
  packets_.reserve(3 * triangles);
  cluster_searches_.reserve(clusters_in_all);
  fit_searchers();
}

SkinContact::~SkinContact() = default;

Vec3 SkinContact::position(int side, const ContactPoint& point) const {
  return surfaces_[side].point(point.face, point.weights);
}

Vec3 SkinContact::position(const Spring& spring) const {
  return position(spring.side, points(spring.side)[static_cast<std::size_t>(spring.point)]);
}

void SkinContact::set_foot(Spring& spring, const Foot& foot, bool is_inside) const {
  const double distance = std::sqrt(foot.at.distance2);
  spring.face = foot.face;
  spring.weights = foot.at.weights;
  spring.reach = -foot.at.away;
  spring.gap = is_inside ? -distance : distance;
  spring.clear = is_inside ? 0.0 : travelled_ + distance;
  spring.is_placed = true;
}

void SkinContact::add_spring(int side, int point, const Foot& foot, bool is_inside,
                             std::vector<Spring>& out) const {
  out.push_back({.side = side, .point = point});
  set_foot(out.back(), foot, is_inside);
}

// Collects all triangles that have a spring, and adds a spring at each of their corners; corners too far
// outside to have been found are not placed. Both lists are sorted by index. The springs found by the search
// are sorted by side and point.
void SkinContact::find_triangles() {
  triangles_.clear();
  added_.clear();
  const std::size_t found = springs_.size();
  for (std::size_t i = 0; i < found; ++i)
    spring_of_[springs_[i].side][static_cast<std::size_t>(springs_[i].point)] = static_cast<int>(i);
  for (std::size_t begin = 0, end = 0; begin < found; begin = end) {
    const int side = springs_[begin].side;
    const ContactMesh& mesh = meshes_[static_cast<std::size_t>(side)];
    std::vector<char>& is_near = is_near_[side];
    int first = static_cast<int>(is_near.size()), last = -1;
    for (end = begin; end < found && springs_[end].side == side; ++end) {
      const auto p = static_cast<std::size_t>(springs_[end].point);
      for (int f = mesh.fan_begin[p]; f < mesh.fan_begin[p + 1]; ++f) {
        const int t = mesh.fan[static_cast<std::size_t>(f)];
        is_near[static_cast<std::size_t>(t)] = 1;
        first = std::min(first, t);
        last = std::max(last, t);
      }
    }
    const auto begin_added = static_cast<std::ptrdiff_t>(added_.size());
    for (int t = first; t <= last; ++t) {
      if (!is_near[static_cast<std::size_t>(t)]) continue;
      is_near[static_cast<std::size_t>(t)] = 0;
      triangles_.push_back({.side = side, .number = t});
      int known = -1;
      const std::size_t before = added_.size();
      for (const int p : triangle(side, t).points) {
        int& spring = spring_of_[side][static_cast<std::size_t>(p)];
        if (spring >= 0) known = spring;
        if (spring != -1) continue;
        spring = -2;
        added_.push_back({.side = side, .point = p});
      }
      for (std::size_t i = before; i < added_.size();
           ++i)  // At least one corner was found and has a near face.
        added_[i].face = springs_[static_cast<std::size_t>(known)].face;
    }
    std::sort(added_.begin() + begin_added, added_.end(),
              [](const Spring& a, const Spring& b) { return a.point < b.point; });
  }
  merge_added();
  for (std::size_t i = 0; i < springs_.size(); ++i)
    spring_of_[springs_[i].side][static_cast<std::size_t>(springs_[i].point)] = static_cast<int>(i);
  for (Triangle& t : triangles_)
    for (std::size_t k = 0; k < 3; ++k)
      t.spring[k] = spring_of_[t.side][static_cast<std::size_t>(triangle(t.side, t.number).points[k])];
  for (const Spring& s : springs_) spring_of_[s.side][static_cast<std::size_t>(s.point)] = -1;
}

/// Merges `added_` into the springs from the end, in place.
void SkinContact::merge_added() {
  const auto is_before = [](const Spring& a, const Spring& b) {
    return std::pair(a.side, a.point) < std::pair(b.side, b.point);
  };
  std::size_t found = springs_.size(), added = added_.size();
  springs_.resize(found + added);
  for (std::size_t to = springs_.size(); added > 0;) {
    const bool takes_found = found > 0 && is_before(added_[added - 1], springs_[found - 1]);
    springs_[--to] = takes_found ? springs_[--found] : added_[--added];
  }
}

/// Calls visit(triangle, overlap at its corners) for each triangle with at least one overlapping corner.
template <class Visit>
void SkinContact::for_each_overlap(const Visit& visit) const {
  for (const Triangle& t : triangles_) {
    const double lowered = triangle(t.side, t.number).lowered;
    Vec3 overlap;
    bool any = false;
    for (std::size_t k = 0; k < 3; ++k) {
      const Spring& s = springs_[static_cast<std::size_t>(t.spring[k])];
      overlap[static_cast<int>(k)] = lowered - s.gap;
      any |= s.is_placed && s.gap < lowered;
    }
    if (any) visit(t, overlap);
  }
}

void SkinContact::integrate() {
  for (Spring& s : springs_) s.stiffness = s.force = s.energy = 0.0;
  for_each_overlap([&](const Triangle& t, const Vec3& overlap) {
    const HatIntegrals integrals = integrate_hats(overlap);
    const double factor = stiffness_ * triangle(t.side, t.number).area;
    for (std::size_t c = 0; c < 3; ++c) {
      Spring& s = springs_[static_cast<std::size_t>(t.spring[c])];
      s.force += factor * integrals.overlap[static_cast<int>(c)];
      s.energy += 0.5 * factor * integrals.overlap[static_cast<int>(c)] * overlap[static_cast<int>(c)];
      s.stiffness += factor * integrals.area[static_cast<int>(c)];
    }
  });
  for (Spring& s : springs_)
    if (s.force == 0.0) s.stiffness = stiffness_ * points(s.side)[static_cast<std::size_t>(s.point)].area;
}

// The relative rounding error of a direction between two points is the unit in the last place of their
// coordinates divided by their distance: 2e-7 at the distance below which the pseudonormal is used, where the
// force of the spring is negligible.
Vec3 SkinContact::outward(const Spring& spring) const { return outward(surfaces_[1 - spring.side], spring); }
Vec3 SkinContact::outward(const Surface& other, const Spring& spring) const {
  constexpr double kCoincide = 1e-9;  // Relative to the coordinates.
  const double size =
      std::max(other.bound().min().cwiseAbs().maxCoeff(), other.bound().max().cwiseAbs().maxCoeff());
  if (std::abs(spring.gap) > kCoincide * size) return -spring.reach / spring.gap;
  return other.outward({spring.face, {.weights = spring.weights}}).normalized();
}

double SkinContact::energy() const {
  double sum = 0.0;
  for (const Spring& s : springs_) sum += s.energy;
  return sum;
}

double SkinContact::deepest() const {
  double most = 0.0;
  for (const Spring& s : springs_)
    if (s.is_placed) most = std::max(most, -s.gap);
  return most;
}

Resultant SkinContact::resultant() const {
  Resultant out;
  for (const Spring& s : springs_) {
    if (s.force == 0.0) continue;
    const Vec3 force = (s.side == 0 ? s.force : -s.force) * outward(s);
    out.force += force;
    out.moment += position(s).cross(force);
  }
  return out;
}

double SkinContact::force_sum() const {
  double sum = 0.0;
  for (const Spring& s : springs_) sum += s.force;
  return sum;
}

double SkinContact::largest_force() const {
  double most = 0.0;
  for (const Spring& s : springs_) most = std::max(most, s.force);
  return most;
}

double SkinContact::quadrature_error() const {
  double error = 0.0;
  for_each_overlap([&](const Triangle& t, const Vec3& overlap) {
    Mat3 x, normal;
    for (int c = 0; c < 3; ++c) {
      const Spring& s = springs_[static_cast<std::size_t>(t.spring[static_cast<std::size_t>(c)])];
      x.col(c) = position(s);
      normal.col(c) = outward(s);
    }
    const HatIntegrals integrals = integrate_hats(overlap);
    const Missed missed = missed_by_linear(x, normal);
    error += stiffness_ * triangle(t.side, t.number).area *
             std::abs(integrals.area.sum() * missed.gap + integrals.overlap.sum() * missed.normal);
  });
  return error;
}

void SkinContact::add_to_vertices(const Spring& spring, const Vec3& force) {
  const ContactPoint& point = points(spring.side)[static_cast<std::size_t>(spring.point)];
  for (int end = 0; end < 2; ++end) {
    const int side = end == 0 ? spring.side : 1 - spring.side;
    const Vec3& weights = end == 0 ? point.weights : spring.weights;
    VertexForces& at = vertex_forces_[side];
    for (int k = 0; k < 3; ++k) {
      const int v = surfaces_[side].skin().faces(k, end == 0 ? point.face : spring.face);
      if (!at.is_touched[static_cast<std::size_t>(v)]) {
        at.is_touched[static_cast<std::size_t>(v)] = 1;
        at.touched.push_back(v);
      }
      at.sum.col(v) += (end == 0 ? weights[k] : -weights[k]) * force;
    }
  }
}

void SkinContact::add_to_nodes(double* nodes_a, double* nodes_b) {
  for (int side = 0; side < 2; ++side) {
    VertexForces& at = vertex_forces_[side];
    const Skin& skin = surfaces_[side].skin();
    double* nodes = side == 0 ? nodes_a : nodes_b;
    for (const int v : at.touched) {
      for (int k = 0; k < 4; ++k)
        Eigen::Map<Vec3>(nodes + 3 * skin.nodes(k, v)) += skin.weights(k, v) * at.sum.col(v);
      at.sum.col(v).setZero();
      at.is_touched[static_cast<std::size_t>(v)] = 0;
    }
    at.touched.clear();
  }
}

void SkinContact::add_force(double* nodes_a, double* nodes_b) {
  for (const Spring& s : springs_)
    if (s.force > 0.0) add_to_vertices(s, s.force * outward(s));
  add_to_nodes(nodes_a, nodes_b);
}

}  // namespace palpate::distance
