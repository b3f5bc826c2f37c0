#include "palpate/distance/skin_contact.h"

#include <algorithm>
#include <cmath>

#include "distance/contact_scratch.h"
#include "palpate/core/error.h"

namespace palpate::distance {

SkinContact::SkinContact(const Skin& a, const Skin& b, const SkinContactSpec& spec)
    : spec_(spec), surfaces_{Surface(a), Surface(b)}, scratch_(std::make_unique<Scratch>()) {
  if (!(spec.stiffness_pa_m > 0.0))
    fail("contact stiffness is {} Pa/m; it must be positive", spec.stiffness_pa_m);
  std::size_t count = 0, most_packets = 1;
  for (int side = 0; side < 2; ++side) {
    const Skin& skin = surfaces_[side].skin();
    const auto clusters = static_cast<std::size_t>(skin.cluster_count());
    if (side == 0 || spec.two_sided)
      points_[side] = contact_points(skin, spec.spacing_m[static_cast<std::size_t>(side)]);
    cluster_points_[side].assign(clusters + 1, 0);
    for (const ContactPoint& p : points_[side])
      ++cluster_points_[side][static_cast<std::size_t>(p.face / kClusterFaces) + 1];
    first_packet_[side] = {0};
    for (std::size_t c = 1; c <= clusters; ++c) {
      const int packets = (cluster_points_[side][c] + kPacket - 1) / kPacket;
      most_packets = std::max(most_packets, static_cast<std::size_t>(packets));
      first_packet_[side].push_back(first_packet_[side].back() + packets);
      cluster_points_[side][c] += cluster_points_[side][c - 1];
    }
    std::array<int, kPacket> none;
    none.fill(-1);
    feet_[side].assign(static_cast<std::size_t>(first_packet_[side].back()), none);
    starts_[side].assign(clusters, -1);
    clear_[side].assign(clusters, -1.0);
    searches_[side] = std::make_unique<LaneSearch>(surfaces_[side]);
    count += points_[side].size();
    candidates_.reserve(std::max(candidates_.capacity(), clusters));
    VertexForces& at = vertex_forces_[side];
    at.sum.setZero(3, skin.vertex_count());
    at.is_touched.assign(static_cast<std::size_t>(skin.vertex_count()), 0);
    at.touched.reserve(static_cast<std::size_t>(skin.vertex_count()));
  }
  springs_.reserve(count);
  packet_.reserve(kPacket);
  scratch_->packets.resize(most_packets);
}

SkinContact::~SkinContact() = default;

Vec3 SkinContact::position(int side, const ContactPoint& point) const {
  return surfaces_[side].point(point.face, point.weights);
}

Vec3 SkinContact::position(const Spring& spring) const {
  return position(spring.side, points_[spring.side][static_cast<std::size_t>(spring.point)]);
}

void SkinContact::set_foot(Spring& spring, const Foot& foot, bool is_inside) const {
  const double distance = std::sqrt(foot.at.distance2);
  spring.face = foot.face;
  spring.weights = foot.at.weights;
  spring.reach = -foot.at.away;
  spring.gap = is_inside ? -distance : distance;
  spring.clear = is_inside ? 0.0 : travelled_ + distance;
}

void SkinContact::add_spring(int side, int point, const Foot& foot, bool is_inside) {
  const ContactPoint& p = points_[side][static_cast<std::size_t>(point)];
  const double factor = spec_.two_sided ? 0.5 * spec_.stiffness_pa_m : spec_.stiffness_pa_m;
  springs_.push_back(
      {.side = side, .point = point, .stiffness = factor * p.area, .coarse = factor * p.coarse});
  set_foot(springs_.back(), foot, is_inside);
}

// A direction between two points is rounded by the unit in the last place of their coordinates over their
// distance: 2e-7 at the distance below which the pseudonormal is taken, where the spring has no force to
// speak of.
Vec3 SkinContact::outward(const Spring& spring) const {
  constexpr double kCoincide = 1e-9;  // of the coordinates
  const Surface& other = surfaces_[1 - spring.side];
  const double size =
      std::max(other.box().min().cwiseAbs().maxCoeff(), other.box().max().cwiseAbs().maxCoeff());
  if (std::abs(spring.gap) > kCoincide * size) return -spring.reach / spring.gap;
  return other.outward({spring.face, {.weights = spring.weights}}).normalized();
}

double SkinContact::energy() const {
  double sum = 0.0;
  for (const Spring& s : springs_)
    if (s.gap < 0.0) sum += 0.5 * s.stiffness * s.reach.squaredNorm();
  return sum;
}

double SkinContact::deepest() const {
  double most = 0.0;
  for (const Spring& s : springs_) most = std::max(most, -s.gap);
  return most;
}

Resultant SkinContact::resultant() const {
  Resultant out;
  for (const Spring& s : springs_) {
    if (s.gap >= 0.0) continue;
    const Vec3 force = (s.side == 0 ? s.stiffness : -s.stiffness) * s.reach;
    out.force += force;
    out.moment += position(s).cross(force);
  }
  return out;
}

EmbeddedSum SkinContact::force_sum() const {
  EmbeddedSum out;
  for (const Spring& s : springs_)
    if (s.gap < 0.0) out.add(s.side == 0 ? s.reach : Vec3(-s.reach), s.stiffness, s.coarse);
  return out;
}

Mat3 SkinContact::spring_matrix(const Spring& spring) const {
  const Vec3& w = spring.weights;
  const int zeros = (w[0] == 0.0) + (w[1] == 0.0) + (w[2] == 0.0);
  if (zeros == 2) return spring.stiffness * Mat3::Identity();
  const Surface& other = surfaces_[1 - spring.side];
  if (zeros == 1) {
    const int k = w[0] == 0.0 ? 0 : w[1] == 0.0 ? 1 : 2;
    const Vec3 t =
        (other.corner(spring.face, (k + 2) % 3) - other.corner(spring.face, (k + 1) % 3)).normalized();
    return spring.stiffness * (Mat3::Identity() - t * t.transpose());
  }
  const Vec3 n = (other.corner(spring.face, 1) - other.corner(spring.face, 0))
                     .cross(other.corner(spring.face, 2) - other.corner(spring.face, 0))
                     .normalized();
  return spring.stiffness * n * n.transpose();
}

/// x - y of values at vertices.
template <class Of>
Vec3 SkinContact::difference(const Spring& spring, const Of& vertex_value) const {
  const ContactPoint& point = points_[spring.side][static_cast<std::size_t>(spring.point)];
  const Skin& own = surfaces_[spring.side].skin();
  const Skin& other = surfaces_[1 - spring.side].skin();
  Vec3 out = Vec3::Zero();
  for (int k = 0; k < 3; ++k)
    out += point.weights[k] * vertex_value(spring.side, own.faces(k, point.face)) -
           spring.weights[k] * vertex_value(1 - spring.side, other.faces(k, spring.face));
  return out;
}

void SkinContact::add_to_vertices(const Spring& spring, const Vec3& force) {
  const ContactPoint& point = points_[spring.side][static_cast<std::size_t>(spring.point)];
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
    if (s.gap < 0.0) add_to_vertices(s, s.stiffness * s.reach);
  add_to_nodes(nodes_a, nodes_b);
}

void SkinContact::apply_stiffness(const double* v_a, const double* v_b, double* y_a, double* y_b) {
  const double* of[2] = {v_a, v_b};
  const auto vertex_value = [&](int side, int v) {
    const Skin& skin = surfaces_[side].skin();
    Vec3 out = Vec3::Zero();
    for (int k = 0; k < 4; ++k)
      out += skin.weights(k, v) * Eigen::Map<const Vec3>(of[side] + 3 * skin.nodes(k, v));
    return out;
  };
  for (const Spring& s : springs_)
    if (s.gap < 0.0) add_to_vertices(s, spring_matrix(s) * difference(s, vertex_value));
  add_to_nodes(y_a, y_b);
}

}  // namespace palpate::distance
