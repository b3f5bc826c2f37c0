#include "contact/material_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/finite.h"
#include "distance/points.h"
#include "mesh/curvature.h"
#include "palpate/core/error.h"
#include "proxy/least_width.h"

// Spacing of contact points. Two bodies of radii r and s touch like a ball of radius R = r s/(r + s) and a
// plane (Hertz). Pressed in by d, they touch in a circle of radius a, a^2 = 2 R d, with the mean depth d/2.
// The gap to a surface of mean curvature H is above its linear interpolation on triangles of edge e by
// H e^2/8 in the mean, which is
//     H R/2 (e/a)^2 of the force.
// Where H is known and taken into account (for a sphere), the remaining error is of second order as well: the
// normals are interpolated, |n_j - n_i|^2/8 = (e/s)^2/8, and by as much H is off deeper inside and, with
// opposite sign, where the triangles are not perpendicular to the normal. With d an eighth of R, a = R/2, and
// (e/s)^2/8 = 1/32 (R/s)^2 (e/a)^2, for whose factor 1/32 tests/contact/material_points_test.cpp finds 0.036,
// a relative error eps requires
//     e = R/2 sqrt(eps/(0.036 (R/s)^2 + H R/2)).
// On a plane there is no error, and triangles are not divided. A contact that is less deep has a smaller
// circle and a larger relative error of a smaller force; the run reports it.

namespace palpate::contact {

CharacteristicLengths lengths_of(const TriMesh& closed) {
  const double radius = mesh::mean_radius(closed);
  return {proxy::least_width(closed.vertices), radius, 1.0 / radius};
}

namespace {

/// Returns the edge length e derived above.
/// @param turn2  (R/s)^2, summed over the known curvatures  @param bend  H of the unknown curvature
double spacing(double R, double turn2, double bend, double wanted_error) {
  constexpr double kKnown = 0.036;
  if (!(wanted_error > 0.0)) fail("contact points: quadrature_error = {} must be positive", wanted_error);
  return 0.5 * R * std::sqrt(wanted_error / (kKnown * turn2 + 0.5 * bend * R));
}

}  // namespace

double point_spacing(const CharacteristicLengths& own, const CharacteristicLengths& other,
                     double wanted_error) {
  const double R = 1.0 / (1.0 / own.radius + 1.0 / other.radius);
  const double e = spacing(R, std::pow(R / other.radius, 2), other.bend, wanted_error);
  return std::isinf(other.radius) ? HUGE_VAL : e;
}

// Material points of a shape lie on a surface that bulges over their triangles. The bulge is known, like
// a sphere's curvature above, and so is the remaining error: the change of the normals between the points.
double shape_spacing(const CharacteristicLengths& shape, const CharacteristicLengths& body,
                     double wanted_error) {
  const double R = 1.0 / (1.0 / shape.radius + 1.0 / body.radius);
  return spacing(R, std::pow(R / body.radius, 2) + std::pow(R / shape.radius, 2), body.bend, wanted_error);
}

namespace {

/// Points on faces, before carriers are assigned.
struct PlacedPoints {
  MaterialPoints out;
  std::vector<distance::ContactPoint> points;
  distance::Skin skin;
  Points at;  ///< Positions at rest [m].
};
PlacedPoints place_points(const TriMesh& rest, double spacing) {
  PlacedPoints placed;
  placed.skin = distance::make_skin(rest);
  MaterialPoints& out = placed.out;
  distance::ContactMesh mesh = distance::contact_mesh(placed.skin, spacing);
  const auto count = static_cast<Eigen::Index>(mesh.points.size()),
             triangles = static_cast<Eigen::Index>(mesh.triangles.size());
  out.at.resize(mesh.points.size());
  placed.at.setZero(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const distance::ContactPoint& point = mesh.points[static_cast<std::size_t>(i)];
    for (int k = 0; k < 3; ++k)
      placed.at.col(i) += point.weights[k] * rest.vertices.col(placed.skin.faces(k, point.face));
  }
  out.triangles.resize(3, triangles);
  out.area.resize(triangles);
  out.edges2.resize(triangles);
  for (Eigen::Index t = 0; t < triangles; ++t) {
    const distance::ContactTriangle& triangle = mesh.triangles[static_cast<std::size_t>(t)];
    out.triangles.col(t) = Eigen::Map<const Eigen::Vector3i>(triangle.points.data());
    out.area[t] = triangle.area;
    const Mat3 x = placed.at(Eigen::all, triangle.points);
    out.edges2[t] = (x.col(0) - x.col(1)).squaredNorm() + (x.col(1) - x.col(2)).squaredNorm() +
                    (x.col(2) - x.col(0)).squaredNorm();
  }
  placed.points = std::move(mesh.points);
  return placed;
}

}  // namespace

// A point of a skin is carried by the tetrahedron that contains it, like the skin's vertices: four nodes
// carry it exactly, whereas the three vertices of its face would involve twelve.
MaterialPoints material_points(const NodeSurface& surface, const Points& rest, const TetMesh& body,
                               double spacing) {
  PlacedPoints placed = place_points({rest, surface.faces}, spacing);
  MaterialPoints& out = placed.out;
  out.block_id = surface.block_id;
  const bool is_skin = surface.node_of_vertex.empty();
  const mesh::Embedding embedding = is_skin ? mesh::embed(body, placed.at) : mesh::Embedding{};
  for (std::size_t i = 0; i < out.at.size(); ++i) {
    SurfacePoint& point = out.at[i];
    const auto hang = [&point](int node, double weight) {
      const auto n = static_cast<std::size_t>(point.count++);
      point.node[n] = node;
      point.weight[n] = weight;
    };
    const auto column = static_cast<Eigen::Index>(i);
    for (int k = 0; k < 4 && is_skin; ++k) hang(body.tets(k, embedding.tet[i]), embedding.weights(k, column));
    for (int k = 0; k < 3 && !is_skin; ++k) {
      const int vertex = placed.skin.faces(k, placed.points[i].face);
      if (const double weight = placed.points[i].weights[k]; weight > 0.0)
        hang(surface.node_of_vertex[static_cast<std::size_t>(vertex)], weight);
    }
  }
  return std::move(out);
}

MaterialPoints material_points(const FrameSurface& surface, double spacing) {
  PlacedPoints placed = place_points(surface.mesh, spacing);
  MaterialPoints& out = placed.out;
  out.motion = surface.motion;
  for (std::size_t i = 0; i < out.at.size(); ++i) {
    out.at[i].frame = surface.frame;
    out.at[i].offset = placed.at.col(static_cast<Eigen::Index>(i));
  }
  return std::move(out);
}

MaterialPointState::MaterialPointState(MaterialPoints points) : points_(std::move(points)) {
  PALPATE_CHECK(
      points_.area.size() == points_.triangles.cols() && points_.edges2.size() == points_.area.size(),
      "material points: {} triangles, {} areas", points_.triangles.cols(), points_.area.size());
  PALPATE_CHECK(is_rigid() || points_.block_id >= 0, "material points have neither a block nor a frame");
  for (const SurfacePoint& point : points_.at) {
    double sum = 0.0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(point.count); ++k) sum += std::abs(point.weight[k]);
    weight_sum_ = std::max(weight_sum_, sum);
    radius_ = std::max(radius_, point.offset.norm());
  }
}

void MaterialPointState::update_frame(const dynamics::StateView& state) {
  pose_ = points_.motion->pose(state);
  twist_ = points_.motion->twist(state);
  R_ = pose_.rotation.toRotationMatrix();
  PALPATE_CHECK(R_.allFinite() && pose_.translation.allFinite(),
                "contact query at t = {}: the pose of a rigid surface is not finite", state.time);
}

const double* MaterialPointState::find_nodes(const dynamics::StateView& state) {
  const dynamics::Block* block = state.layout->find(points_.block_id);
  PALPATE_CHECK(block && block->kind == dynamics::BlockKind::kNodes,
                "material points: block {} is not a node block of this State", points_.block_id);
  if (const int offset = block->u_offset / 3; offset != node_offset_) {
    node_offset_ = offset;
    ++pattern_version_;
  }
  nodes_.resize(3, block->q_size / 3);
  return state.q.data() + block->q_offset;
}

void MaterialPointState::update(const dynamics::StateView& state) {
  if (is_rigid()) return update_frame(state);
  const double* const nodes = find_nodes(state);
  nodes_ = Eigen::Map<const Points>(nodes, 3, nodes_.cols());
  PALPATE_CHECK(all_finite(nodes_), "contact query at t = {}: the position of a node is not finite",
                state.time);
}

void MaterialPointState::update(const dynamics::StateView& state, std::span<const int> points) {
  if (is_rigid()) return update_frame(state);
  const double* const nodes = find_nodes(state);
  for (const int point : points) {
    const SurfacePoint& p = at(point);
    for (std::size_t k = 0; k < static_cast<std::size_t>(p.count); ++k)
      nodes_.col(p.node[k]) = Eigen::Map<const Vec3>(nodes + 3 * p.node[k]);
  }
}

Vec3 MaterialPointState::position(int point, const Points& nodes, const Mat3& R, const Vec3& t) const {
  const SurfacePoint& p = at(point);
  if (is_rigid()) return R * p.offset + t;
  Vec3 x = Vec3::Zero();
  for (std::size_t k = 0; k < static_cast<std::size_t>(p.count); ++k) x += p.weight[k] * nodes.col(p.node[k]);
  return x;
}

Vec3 MaterialPointState::position(int point) const { return position(point, nodes_, R_, pose_.translation); }

Vec3 MaterialPointState::kept_position(int point) const {
  return position(point, kept_nodes_, kept_R_, kept_pose_.translation);
}

void MaterialPointState::keep() {
  is_kept_ = true;
  kept_nodes_ = nodes_;
  kept_pose_ = pose_;
  kept_R_ = R_;
}

// A point on nodes moves by sum w_i dx_i, at most sum |w_i| times the largest |dx_i|; a point of a frame by
// dt + dR o, and a rotation by theta moves o by at most 2 |o| sin(theta/2).
double MaterialPointState::way() const {
  if (!is_kept_) return HUGE_VAL;
  if (is_rigid()) {
    const double angle = rotation_vector(pose_.rotation * kept_pose_.rotation.conjugate()).norm();
    return (pose_.translation - kept_pose_.translation).norm() + 2.0 * std::sin(0.5 * angle) * radius_;
  }
  return weight_sum_ * std::sqrt((nodes_ - kept_nodes_).colwise().squaredNorm().maxCoeff());
}

double MaterialPointState::fastest(const dynamics::StateView& state) const {
  if (is_rigid()) return twist_.linear.norm() + twist_.angular.norm() * radius_;
  const dynamics::Block* block = state.layout->find(points_.block_id);
  const Eigen::Map<const Points> v(state.u.data() + block->u_offset, 3, block->u_size / 3);
  return weight_sum_ * std::sqrt(v.colwise().squaredNorm().maxCoeff());
}

Vec3 MaterialPointState::velocity(int point, const dynamics::StateView& state) const {
  const SurfacePoint& p = at(point);
  if (is_rigid()) return twist_.at(R_ * p.offset);
  Vec3 v = Vec3::Zero();
  for (std::size_t k = 0; k < static_cast<std::size_t>(p.count); ++k)
    v += p.weight[k] * state.velocity(node_offset_ + p.node[k]);
  return v;
}

SurfacePoint MaterialPointState::vertex_point(int point) const {
  SurfacePoint out = at(point);
  for (std::size_t k = 0; k < static_cast<std::size_t>(out.count); ++k) out.node[k] += node_offset_;
  return out;
}

double MaterialPointState::farthest_from(const Vec3& x) const {
  if (is_rigid()) return (pose_.translation - x).norm() + radius_;
  return weight_sum_ * std::sqrt((nodes_.colwise() - x).colwise().squaredNorm().maxCoeff());
}

double MaterialPointState::mean_edge() const {
  return vertex_count() > 0 ? std::sqrt(points_.area.sum() / vertex_count()) : 0.0;
}

void MaterialPointState::add_vertex_pattern(dynamics::PatternBuilder& pattern) const {
  if (is_rigid()) return;
  std::vector<std::array<int, 4>> carriers;
  for (const SurfacePoint& point : points_.at) {
    carriers.push_back({-1, -1, -1, -1});
    for (std::size_t k = 0; k < static_cast<std::size_t>(point.count); ++k)
      carriers.back()[k] = node_offset_ + point.node[k];
  }
  std::sort(carriers.begin(), carriers.end());
  carriers.erase(std::unique(carriers.begin(), carriers.end()), carriers.end());
  for (const std::array<int, 4>& nodes : carriers)
    pattern.add_clique(nodes.data(),
                       static_cast<int>(std::find(nodes.begin(), nodes.end(), -1) - nodes.begin()));
}

}  // namespace palpate::contact
