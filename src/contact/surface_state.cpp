#include "contact/surface_state.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/counters.h"
#include "core/finite.h"
#include "palpate/core/error.h"
#include "palpate/mesh/embedding.h"

namespace palpate::contact {

SurfaceState::SurfaceState(NodeSurface surface) : surface_(std::move(surface)) {
  vertex_count_ = is_skin() ? surface_.embedding.size() : static_cast<int>(surface_.node_of_vertex.size());
  positions_.resize(3, vertex_count_);
  if (is_skin()) evaluated_.assign(static_cast<std::size_t>(vertex_count_), 0);
  for (int f = 0; f < face_count(); ++f)
    for (int k = 0; k < 3; ++k)
      PALPATE_CHECK(surface_.faces(k, f) >= 0 && surface_.faces(k, f) < vertex_count(),
                    "contact surface: face {} refers to vertex {} of {}", f, surface_.faces(k, f),
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
                "contact skin: a vertex is embedded in tetrahedron {} of {}",
                carriers_.front() < 0 ? carriers_.front() : carriers_.back(), surface_.tets.cols());
}

void SurfaceState::update(const dynamics::StateView& state) {
  const dynamics::Block* block = state.layout->find(surface_.block_id);
  PALPATE_CHECK(block && block->kind == dynamics::BlockKind::kNodes,
                "contact surface: block {} is not a node block of this State", surface_.block_id);
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
  PALPATE_CHECK(all_finite(is_skin() ? nodes_ : positions_),
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

// The corners of a face of a skin may be carried by three tetrahedra, twelve nodes in all, whereas a contact
// point has four. It is attached to the tetrahedron of the corner nearest to it, by its barycentric
// coordinates there in the present configuration: it keeps its position, and a force on it keeps its moment.
// Between two queries it moves with that tetrahedron, and deviates from the face by a fraction of the
// difference of the tetrahedra's strains.
//
// In a tetrahedron squashed relative to its neighbours the coordinates w grow as 1 / height: a force f acts
// on the nodes as w f, and a stiffness k as w^2 k. The sum |w| is therefore kept below the limit for an
// embedding. A force along n has the same moment at any point of its line, so that the point may be carried
// by a point displaced along n: of all weights with
//     sum w_i = 1,   sum w_i P x_i = P x,   P = I - n n^T
// the least ones,
//     w_i = 1/4 + p_i^T (sum p_j p_j^T)^-1 p,
// with p_i and p the P x_i and P x relative to the mean of the corners, are bounded however low the
// tetrahedron is along n. The remaining offset along n does not rotate: gap and moment are correct to first
// order, and the moment of friction is off by friction times offset. Where that is not sufficient, the
// tetrahedra of the face's other corners are tried. As a last resort, if all three are flat and seen edge-on,
// the corner's embedding weights carry the point, with a moment of the offset times the force.
//
// All these weights are affine in the place, except the last, which are constant. Carriers are numbered: for
// tetrahedron t, 2 t with its coordinates and 2 t + 1 with the least weights; then the vertices with their
// embedding weights. For a surface whose vertices are nodes the carriers are its faces.
int SurfaceState::carrier_choices() const { return is_skin() ? 9 : 1; }

int SurfaceState::carrier_choice(int face, int corner, int choice) const {
  if (!is_skin()) return face;
  const auto of = [&](int k) { return 2 * tet_of(surface_.faces(k, face)); };
  if (choice < 2) return of(corner) + choice;
  if (choice < 5) return of(choice - 2);
  if (choice < 8) return of(choice - 5) + 1;
  return 2 * static_cast<int>(surface_.tets.cols()) + surface_.faces(corner, face);
}

namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kFlatTetrahedron = 1e-6;  // Volume divided by the cube of the longest edge.

/// Returns the barycentric coordinates as a function of place, for a tetrahedron with these corners, the
/// first at 0; NaN for one that is too flat.
Mat4 coordinates_in(const Mat34& x) {
  const Mat3 edges = x.rightCols<3>();
  const double size = edges.colwise().norm().maxCoeff();
  if (!(std::abs(edges.determinant()) > kFlatTetrahedron * size * size * size))
    return Mat4::Constant(kNoNumber);
  Mat4 out = Mat4::Zero();
  out.bottomLeftCorner<3, 3>() = edges.inverse();
  out.row(0) = Vec4(0.0, 0.0, 0.0, 1.0).transpose() - out.bottomRows<3>().colwise().sum();
  return out;
}

/// Returns the least-squares weights as a function of place, for a point on the line through it along w; NaN
/// where the corners are collinear as seen along w.
Mat4 least_weights(const Mat34& x) {
  constexpr double kEdgeOn = 1e-12;
  const Eigen::Vector2d middle = x.topRows<2>().rowwise().mean();
  const Eigen::Matrix<double, 2, 4> p = x.topRows<2>().colwise() - middle;
  const Eigen::Matrix2d squares = p * p.transpose();
  if (!(squares.determinant() > kEdgeOn * squares.trace() * squares.trace()))
    return Mat4::Constant(kNoNumber);
  Mat4 out = Mat4::Zero();
  out.leftCols<2>().noalias() = p.transpose() * squares.inverse();
  out.col(3) = Vec4::Constant(0.25) - out.leftCols<2>() * middle;
  return out;
}

/// Returns the weights of a triangle with its first corner at 0, seen along w, as a function of place;
/// constant where it is seen edge-on.
Mat4 coordinates_in_face(const Mat34& x) {
  const Eigen::Matrix2d edges = x.block<2, 2>(0, 1);
  Mat4 out = Mat4::Zero();
  if (edges.determinant() == 0.0) {
    out.col(3) = Vec4(1.0, 1.0, 1.0, 0.0) / 3.0;
    return out;
  }
  out.block<2, 2>(1, 0) = edges.inverse();
  out.row(0) = Vec4(0.0, 0.0, 0.0, 1.0).transpose() - out.row(1) - out.row(2);
  return out;
}

}  // namespace

// With the nodes at x_i relative to the first one, the place p = (u, v, w, 1) is carried to sum (B p)_i x_i,
// at the height sum (B p)_i w_i. `beside` is the difference to w, zero up to rounding where the point is on
// the carrier.
Carrier SurfaceState::carrier(int number, const ContactAxes& axes) const {
  Carrier out;
  const Tets& tets = surface_.tets;
  const auto nodes_of = [&](int tet) {
    for (int k = 0; k < 4; ++k) out.node[static_cast<std::size_t>(k)] = node_of_tet(tet, k);
  };
  Mat34 x = Mat34::Zero();  // Positions of the carrier's nodes in the axes, relative to the first.
  if (!is_skin()) {
    out.count = 3;
    const int first = surface_.faces(0, number);
    for (int k = 0; k < 3; ++k) {
      const int vertex = surface_.faces(k, number);
      out.node[static_cast<std::size_t>(k)] = node(vertex);
      x.col(k).noalias() = axes.to_world.transpose() * (positions_.col(vertex) - positions_.col(first));
    }
    out.at = axes.in_axes(positions_.col(first));
    out.by_place = coordinates_in_face(x);
  } else {
    out.count = 4;
    const int vertex = number - 2 * static_cast<int>(tets.cols()),
              tet = vertex >= 0 ? tet_of(vertex) : number / 2;
    nodes_of(tet);
    out.at = axes.in_axes(nodes_.col(tets(0, tet)));
    for (int k = 1; k < 4; ++k)  // Relative to the first.
      x.col(k).noalias() = axes.to_world.transpose() * (nodes_.col(tets(k, tet)) - nodes_.col(tets(0, tet)));
    if (vertex >= 0)
      out.by_place.col(3) = surface_.embedding.weights.col(vertex);
    else
      out.by_place = number % 2 == 0 ? coordinates_in(x) : least_weights(x);
  }
  out.beside = Vec4(0.0, 0.0, 1.0, 0.0) - out.by_place.transpose() * x.row(2).transpose();
  return out;
}

CarriedPoint SurfaceState::carried(int face, const Vec3& weights, const Vec3& x, const Vec3& normal) const {
  // Weights of a vertex embedded at the bound may exceed it by rounding.
  constexpr double kBound = (1.0 + 1e-9) * mesh::kLargestWeightSum;
  CarriedPoint out;
  SurfacePoint& point = out.point;
  if (!is_skin()) {
    out.number = face;
    point.count = 3;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto corner = static_cast<Eigen::Index>(k);
      point.node[k] = node(surface_.faces(corner, face));
      point.weight[k] = weights[corner];
    }
    return out;
  }
  Eigen::Index corner = 0;
  weights.maxCoeff(&corner);
  // First choice, without axes: x = sum w_i x_i in three equations.
  out.number = carrier_choice(face, static_cast<int>(corner), 0);
  const auto tet = surface_.tets.col(out.number / 2);
  const Vec3 x0 = nodes_.col(tet[0]);
  const Vec3 a = nodes_.col(tet[1]) - x0, b = nodes_.col(tet[2]) - x0, c = nodes_.col(tet[3]) - x0,
             p = x - x0, bc = b.cross(c);
  const double det = a.dot(bc), size2 = std::max({a.squaredNorm(), b.squaredNorm(), c.squaredNorm()});
  if (std::abs(det) > kFlatTetrahedron * size2 * std::sqrt(size2)) {
    const double wa = p.dot(bc) / det, wb = a.dot(p.cross(c)) / det, wc = a.dot(b.cross(p)) / det,
                 w0 = 1.0 - wa - wb - wc;
    if (std::abs(w0) + std::abs(wa) + std::abs(wb) + std::abs(wc) <= kBound) {
      point.count = 4;
      point.weight = {w0, wa, wb, wc};
      for (std::size_t k = 0; k < 4; ++k) point.node[k] = node_offset_ + tet[static_cast<Eigen::Index>(k)];
      return out;
    }
  }
  counters::count("contact.squashed_tetrahedron");
  const ContactAxes axes(x, normal);
  for (int choice = 1; choice < carrier_choices(); ++choice) {
    out.number = carrier_choice(face, static_cast<int>(corner), choice);
    const Carrier by = carrier(out.number, axes);
    point = point_of(by, axes.in_axes(x) - by.at, axes.normal());
    double sum = 0.0;
    for (const double w : point.weight) sum += std::abs(w);
    if (sum <= kBound) break;
  }
  return out;
}

// Area vector of a face: (x1 - x0) x (x2 - x0) / 2, outward.
void SurfaceState::area_vectors(const std::vector<char>& requested, Points& areas) const {
  areas.setZero(3, vertex_count());
  for (int f = 0; f < face_count(); ++f) {
    const int i = surface_.faces(0, f), j = surface_.faces(1, f), k = surface_.faces(2, f);
    if (!requested[static_cast<std::size_t>(i)] && !requested[static_cast<std::size_t>(j)] &&
        !requested[static_cast<std::size_t>(k)])
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
