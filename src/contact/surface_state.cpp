#include "contact/surface_state.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "palpate/core/counters.h"
#include "palpate/core/error.h"

namespace palpate::contact {

SurfaceState::SurfaceState(NodeSurface surface) : surface_(std::move(surface)) {
  vertex_count_ = is_skin() ? surface_.embedding.size() : static_cast<int>(surface_.node_of_vertex.size());
  positions_.resize(3, vertex_count_);
  if (is_skin()) evaluated_.assign(static_cast<std::size_t>(vertex_count_), 0);
  for (int f = 0; f < face_count(); ++f)
    for (int k = 0; k < 3; ++k)
      PALPATE_CHECK(surface_.faces(k, f) >= 0 && surface_.faces(k, f) < vertex_count(),
                    "contact surface: face {} names vertex {} of {}", f, surface_.faces(k, f),
                    vertex_count());
  if (!is_skin()) return;
  PALPATE_CHECK(surface_.embedding.weights.cols() == vertex_count(),
                "contact skin: {} weights for {} vertices", surface_.embedding.weights.cols(),
                vertex_count());
  for (int v = 0; v < vertex_count_; ++v)
    weight_sum_ = std::max(weight_sum_, surface_.embedding.weights.col(v).cwiseAbs().sum());
  carriers_ = surface_.embedding.tet;
  std::sort(carriers_.begin(), carriers_.end());
  carriers_.erase(std::unique(carriers_.begin(), carriers_.end()), carriers_.end());
  if (carriers_.empty()) return;
  PALPATE_CHECK(carriers_.front() >= 0 && carriers_.back() < surface_.tets.cols(),
                "contact skin: a vertex hangs on tetrahedron {} of {}",
                carriers_.front() < 0 ? carriers_.front() : carriers_.back(), surface_.tets.cols());
}

void SurfaceState::update(const dynamics::StateView& state) {
  const dynamics::Block* block = state.layout->find(surface_.block_id);
  PALPATE_CHECK(block && block->kind == dynamics::BlockKind::kNodes,
                "contact surface: block {} is no node block of this State", surface_.block_id);
  if (const int offset = block->u_offset / 3; offset != node_offset_) {
    node_offset_ = offset;
    ++pattern_version_;
  }
  ++updates_;
  if (is_skin()) {
    nodes_ = Eigen::Map<const Points>(state.q.data() + block->q_offset, 3, block->q_size / 3);
  } else {
    for (int v = 0; v < vertex_count(); ++v) positions_.col(v) = state.position(node(v));
  }
  PALPATE_CHECK((is_skin() ? nodes_ : positions_).allFinite(),
                "contact query at t = {}: a surface position is not finite", state.time);
}

const Points& SurfaceState::positions() const {
  if (is_skin() && all_evaluated_ != updates_) {
    mesh::evaluate(surface_.embedding, surface_.tets, nodes_, positions_);
    std::fill(evaluated_.begin(), evaluated_.end(), static_cast<std::uint32_t>(updates_));
    all_evaluated_ = updates_;
    evaluations_ += vertex_count_;
  }
  return positions_;
}

void SurfaceState::evaluate(int vertex) const {
  const auto corner = surface_.tets.col(tet_of(vertex));
  const auto w = surface_.embedding.weights.col(vertex);
  positions_.col(vertex) = w[0] * nodes_.col(corner[0]) + w[1] * nodes_.col(corner[1]) +
                           w[2] * nodes_.col(corner[2]) + w[3] * nodes_.col(corner[3]);
  evaluated_[static_cast<std::size_t>(vertex)] = static_cast<std::uint32_t>(updates_);
  ++evaluations_;
}

Vec3 SurfaceState::position(int vertex, const Points& carriers) const {
  if (!is_skin()) return carriers.col(vertex);
  Vec3 x = Vec3::Zero();
  for (int k = 0; k < 4; ++k)
    x += surface_.embedding.weights(k, vertex) * carriers.col(surface_.tets(k, tet_of(vertex)));
  return x;
}

Vec3 SurfaceState::velocity(int vertex, const dynamics::StateView& state) const {
  if (!is_skin()) return state.velocity(node(vertex));
  Vec3 v = Vec3::Zero();
  for (int k = 0; k < 4; ++k)
    v += surface_.embedding.weights(k, vertex) * state.velocity(node_of_tet(tet_of(vertex), k));
  return v;
}

Eigen::Map<const Points> SurfaceState::node_velocities(const dynamics::StateView& state) const {
  const dynamics::Block* block = state.layout->find(surface_.block_id);
  return {state.u.data() + block->u_offset, 3, block->u_size / 3};
}

SurfacePoint SurfaceState::vertex_point(int vertex) const {
  SurfacePoint point;
  point.count = is_skin() ? 4 : 1;
  for (int k = 0; k < point.count; ++k) {
    point.node[static_cast<std::size_t>(k)] = is_skin() ? node_of_tet(tet_of(vertex), k) : node(vertex);
    point.weight[static_cast<std::size_t>(k)] = is_skin() ? surface_.embedding.weights(k, vertex) : 1.0;
  }
  return point;
}

// The corners of a face of a skin may hang on three tetrahedra, twelve nodes in all; a contact point has
// four.  It is tied to the tetrahedron of the corner nearest to it, by its barycentric coordinates there as
// it stands now: so it lies where it is seen, and a force at it keeps its moment.  Between two queries it
// moves with that one tetrahedron, and leaves the face by a part of the difference of the tetrahedra's
// strains.
//
// In a tetrahedron that is squashed against its neighbours the coordinates w grow as 1 / height: a force f
// reaches the nodes as w f, and a stiffness k as w^2 k.  The sum |w| is therefore held below that which an
// embedding may have.  A force along n keeps its moment at any point of its line, so the point may be carried
// by one that differs from it along n: of all weights with
//     sum w_i = 1,   sum w_i P x_i = P x,   P = I - n n^T
// the least ones,
//     w_i = 1/4 + p_i^T (sum p_j p_j^T)^-1 p,
// p_i and p the P x_i and P x about the mean of the corners, are bounded however low the tetrahedron is along
// n.  The offset left along n does not rotate: gap and moment are right to first order, and friction's moment
// is off by friction times offset.  Where that is not enough, the tetrahedra of the face's other corners
// are tried.
SurfacePoint SurfaceState::face_point(int face, const Vec3& weights, const Vec3& normal) const {
  const auto corner = surface_.faces.col(face);
  if (!is_skin()) {
    SurfacePoint point;
    point.count = 3;
    for (int k = 0; k < 3; ++k) {
      point.node[static_cast<std::size_t>(k)] = node(corner[k]);
      point.weight[static_cast<std::size_t>(k)] = weights[k];
    }
    return point;
  }
  Eigen::Index nearest = 0;
  weights.maxCoeff(&nearest);
  const Vec3 x =
      weights[0] * position(corner[0]) + weights[1] * position(corner[1]) + weights[2] * position(corner[2]);
  const int own = tet_of(corner[nearest]);
  const Weights of_corner = surface_.embedding.weights.col(corner[nearest]);
  if (weights[nearest] == 1.0) return point_of_tet(own, x, of_corner);  // a vertex
  const auto is_bounded = [](const Weights& w) { return w.cwiseAbs().sum() <= mesh::kLargestWeightSum; };
  if (const Weights w = weights_at(own, x); is_bounded(w)) return point_of_tet(own, x, w);
  counters::count("contact.squashed_tetrahedron");
  if (const Weights w = weights_on_line(own, x, normal); is_bounded(w)) return point_of_tet(own, x, w);
  for (int k = 0; k < 3; ++k)
    if (const Weights w = weights_at(tet_of(corner[k]), x); is_bounded(w))
      return point_of_tet(tet_of(corner[k]), x, w);
  for (int k = 0; k < 3; ++k)
    if (const Weights w = weights_on_line(tet_of(corner[k]), x, normal); is_bounded(w))
      return point_of_tet(tet_of(corner[k]), x, w);
  // all three flat and seen edge-on: the corner's own weights, and a moment of the offset times the force
  return point_of_tet(own, x, of_corner);
}

const SurfaceState::TetFrame& SurfaceState::frame_of(int tet) const {
  constexpr double kFlat = 1e-6;  // volume over the cube of the longest edge
  if (frames_.empty()) frames_.resize(static_cast<std::size_t>(surface_.tets.cols()));
  TetFrame& frame = frames_[static_cast<std::size_t>(tet)];
  if (frame.made == updates_) return frame;
  Mat3 edges;
  for (int k = 0; k < 3; ++k)
    edges.col(k) = nodes_.col(surface_.tets(k + 1, tet)) - nodes_.col(surface_.tets(0, tet));
  const double size = edges.colwise().norm().maxCoeff();
  frame.flat = std::abs(edges.determinant()) <= kFlat * size * size * size;
  if (!frame.flat) frame.inverse_edges = edges.inverse();
  frame.made = updates_;
  return frame;
}

SurfaceState::Weights SurfaceState::weights_at(int tet, const Vec3& x) const {
  const TetFrame& frame = frame_of(tet);
  if (frame.flat) return Weights::Constant(std::numeric_limits<double>::quiet_NaN());
  Weights w;
  w.tail<3>().noalias() = frame.inverse_edges * (x - nodes_.col(surface_.tets(0, tet)));
  w[0] = 1.0 - w.tail<3>().sum();
  return w;
}

SurfaceState::Weights SurfaceState::weights_on_line(int tet, const Vec3& x, const Vec3& normal) const {
  constexpr double kEdgeOn = 1e-12;
  Eigen::Matrix<double, 3, 2> across;
  across.col(0) = normal.unitOrthogonal();
  across.col(1) = normal.cross(across.col(0));
  Eigen::Matrix<double, 2, 4> p;
  for (int k = 0; k < 4; ++k) p.col(k).noalias() = across.transpose() * nodes_.col(surface_.tets(k, tet));
  const Eigen::Vector2d middle = p.rowwise().mean();
  p.colwise() -= middle;
  const Eigen::Matrix2d squares = p * p.transpose();
  if (!(squares.determinant() > kEdgeOn * squares.trace() * squares.trace()))
    return Weights::Constant(std::numeric_limits<double>::quiet_NaN());
  const Eigen::Vector2d at = squares.inverse() * (across.transpose() * x - middle);
  return Weights::Constant(0.25) + p.transpose() * at;
}

SurfacePoint SurfaceState::point_of_tet(int tet, const Vec3& x, const Weights& weights) const {
  SurfacePoint point;
  point.count = 4;
  point.offset = x;
  for (int k = 0; k < 4; ++k) {
    point.node[static_cast<std::size_t>(k)] = node_of_tet(tet, k);
    point.weight[static_cast<std::size_t>(k)] = weights[k];
    point.offset -= weights[k] * nodes_.col(surface_.tets(k, tet));  // rounding, but of a squashed one
  }
  return point;
}

// Area vector of a face: (x1 - x0) x (x2 - x0) / 2, outward.
void SurfaceState::area_vectors(const std::vector<char>& wanted, Points& areas) const {
  areas.setZero(3, vertex_count());
  for (int f = 0; f < face_count(); ++f) {
    const int i = surface_.faces(0, f), j = surface_.faces(1, f), k = surface_.faces(2, f);
    if (!wanted[static_cast<std::size_t>(i)] && !wanted[static_cast<std::size_t>(j)] &&
        !wanted[static_cast<std::size_t>(k)])
      continue;
    const Vec3 edge1 = position(j) - position(i), edge2 = position(k) - position(i);
    const Vec3 third = edge1.cross(edge2) / 6.0;
    for (const int v : {i, j, k}) areas.col(v) += third;
  }
}

double SurfaceState::mean_edge() const {
  const Points& x = positions();
  double sum = 0.0;
  for (int f = 0; f < face_count(); ++f)
    for (int k = 0; k < 3; ++k)
      sum += (x.col(surface_.faces(k, f)) - x.col(surface_.faces((k + 1) % 3, f))).norm();
  return face_count() > 0 ? sum / (3.0 * face_count()) : 0.0;
}

NodeNeighbours SurfaceState::neighbours() const {
  if (is_skin()) return {surface_.tets, node_offset_};
  Eigen::MatrixXi faces(3, face_count());
  for (int f = 0; f < face_count(); ++f)
    for (int k = 0; k < 3; ++k)
      faces(k, f) = surface_.node_of_vertex[static_cast<std::size_t>(surface_.faces(k, f))];
  return {faces, node_offset_};
}

void SurfaceState::add_vertex_pattern(dynamics::PatternBuilder& pattern) const {
  for (const int tet : carriers_) {
    const int nodes[4] = {node_of_tet(tet, 0), node_of_tet(tet, 1), node_of_tet(tet, 2), node_of_tet(tet, 3)};
    pattern.add_clique(nodes, 4);
  }
}

void SurfaceState::add_face_pattern(dynamics::PatternBuilder& pattern) const {
  if (is_skin()) return add_vertex_pattern(pattern);
  for (int f = 0; f < face_count(); ++f) {
    const int nodes[3] = {node(surface_.faces(0, f)), node(surface_.faces(1, f)), node(surface_.faces(2, f))};
    pattern.add_clique(nodes, 3);
  }
}

SurfacePoint frame_point(int frame, const Pose& inverse_pose, const Vec3& world) {
  SurfacePoint point;
  point.frame = frame;
  point.offset = inverse_pose * world;
  return point;
}

}  // namespace palpate::contact
