#include "statics.h"

#include <cmath>
#include <limits>

#include <Eigen/LU>

#include "palpate/mesh/boundary.h"

namespace palpate::validation {

StaticBody::StaticBody(const TetMesh& rest, const fem::Materials& materials,
                       const fem::SoftBodyOptions& options)
    : rest_(rest), state_(static_cast<int>(rest.nodes.size()), static_cast<int>(rest.nodes.size())) {
  x_ = rest.nodes.reshaped();
  v_ = VecX::Zero(x_.size());
  external_ = Points::Zero(3, rest.nodes.cols());
  held_.assign(static_cast<std::size_t>(x_.size()), 0);
  dynamics::BlockSpec spec;
  spec.name = "body";
  spec.q_size = spec.u_size = static_cast<int>(x_.size());
  block_ = state_.insert(spec, x_, v_);
  body_ = std::make_shared<fem::SoftBody>("body", rest, materials, options, block_);
  terms_ = {body_};
  if (options.volumetric_share < 1.0)
    terms_.push_back(std::make_shared<fem::NodalDilatation>("body", rest, materials, options, block_));
}

void StaticBody::add(const std::function<std::shared_ptr<dynamics::ForceTerm>(int)>& make) {
  terms_.push_back(make(block_));
}

void StaticBody::hold(int node, int axis, double position) {
  held_[static_cast<std::size_t>(3 * node + axis)] = 1;
  x_[3 * node + axis] = position;
}

void StaticBody::hold(int node, const Vec3& position) {
  for (int axis = 0; axis < 3; ++axis) hold(node, axis, position[axis]);
}

void StaticBody::internal_force(VecX& f) {
  f.setZero(x_.size());
  for (const auto& term : terms_) term->add_force(view(), f);
}

bool StaticBody::newton_step(const VecX& residual) {
  const bool same_pattern = terms_in_pattern_ == terms_.size();
  if (!same_pattern) {
    dynamics::PatternBuilder builder(state_.layout());
    for (const auto& term : terms_) term->add_pattern(builder);
    K_.body = builder.build();
    terms_in_pattern_ = terms_.size();
  }
  K_.set_zero();
  for (const auto& term : terms_) term->add_tangent(view(), 1.0, 0.0, K_);
  std::vector<int> number(held_.size(), -1);
  int free = 0;
  for (std::size_t i = 0; i < held_.size(); ++i)
    if (!held_[i]) number[i] = free++;

  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(K_.body.slot_count()) * 5);
  for (int i = 0; i < K_.body.block_rows(); ++i)
    for (int s = K_.body.row_start()[static_cast<std::size_t>(i)];
         s < K_.body.row_start()[static_cast<std::size_t>(i) + 1]; ++s)
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) {
          const int row = number[static_cast<std::size_t>(3 * i + r)];
          const int column =
              number[static_cast<std::size_t>(3 * K_.body.columns()[static_cast<std::size_t>(s)] + c)];
          if (row >= 0 && column >= 0 && column <= row)
            entries.emplace_back(row, column, K_.body.block(s)[3 * r + c]);
        }
  Eigen::SparseMatrix<double> A(free, free);
  A.setFromTriplets(entries.begin(), entries.end());
  VecX b(free);
  for (std::size_t i = 0; i < held_.size(); ++i)
    if (number[i] >= 0) b[number[i]] = residual[static_cast<Eigen::Index>(i)];

  if (!same_pattern || held_in_factor_ != held_) {
    factor_.analyzePattern(A);
    held_in_factor_ = held_;
  }
  factor_.factorize(A);
  if (factor_.info() != Eigen::Success) return false;
  const VecX dx = factor_.solve(b);
  if (!dx.allFinite()) return false;
  for (std::size_t i = 0; i < held_.size(); ++i)
    if (number[i] >= 0) x_[static_cast<Eigen::Index>(i)] += dx[number[i]];
  return true;
}

bool StaticBody::solve(double good_enough) {
  constexpr int kMaxIterations = 50;
  double best = std::numeric_limits<double>::infinity();
  VecX f;
  for (int i = 0; i < kMaxIterations; ++i) {
    internal_force(f);
    VecX residual = f + external_.reshaped();
    const double scale = residual.norm() + external_.norm();  // reactions included
    for (std::size_t k = 0; k < held_.size(); ++k)
      if (held_[k]) residual[static_cast<Eigen::Index>(k)] = 0.0;
    const double relative = scale > 0.0 ? residual.norm() / scale : 0.0;
    if (!std::isfinite(relative)) return false;
    if (relative == 0.0 || (relative < good_enough && relative > 0.3 * best)) return true;
    best = std::min(best, relative);
    if (!newton_step(residual)) return false;
  }
  return false;
}

bool StaticBody::solve_linear() {
  VecX residual;
  internal_force(residual);
  residual += external_.reshaped();
  return newton_step(residual);
}

double StaticBody::elastic_energy() {
  double sum = 0.0;
  for (const auto& term : terms_) sum += term->energy(view());
  return sum;
}

Points StaticBody::internal_forces() {
  VecX f;
  internal_force(f);
  return f.reshaped(3, rest_.nodes.cols());
}

// Balance div P = -b, so the integral of P is that of traction X^T and body force X^T: nodal forces times
// rest positions. In equilibrium those are minus the internal ones.
Mat3 StaticBody::mean_stress() {
  VecX f;
  internal_force(f);
  return -Points(f.reshaped(3, rest_.nodes.cols())) * rest_.nodes.transpose() / volume(rest_);
}

double volume(const TetMesh& mesh) {
  double sum = 0.0;
  for (const auto& tet : mesh.tets.colwise()) {
    Mat3 edges;
    for (int a = 0; a < 3; ++a) edges.col(a) = mesh.nodes.col(tet[a + 1]) - mesh.nodes.col(tet[0]);
    sum += edges.determinant() / 6.0;
  }
  return sum;
}

VecX end_loads(const TetMesh& mesh, double length, const std::function<double(double y)>& traction) {
  VecX loads = VecX::Zero(mesh.nodes.cols());
  for (const auto& tet : mesh.tets.colwise())
    for (int skip = 0; skip < 4; ++skip) {
      int face[3], k = 0;
      for (int a = 0; a < 4; ++a)
        if (a != skip) face[k++] = tet[a];
      bool end = true;
      for (int node : face) end = end && mesh.nodes(0, node) > length - 1e-9;
      if (!end) continue;
      const Vec3 a = mesh.nodes.col(face[0]), b = mesh.nodes.col(face[1]), c = mesh.nodes.col(face[2]);
      const double third = (b - a).cross(c - a).norm() / 6.0;
      for (int e = 0; e < 3; ++e) {
        const int i = face[e], j = face[(e + 1) % 3];
        const double half = 0.5 * third * traction(0.5 * (mesh.nodes(1, i) + mesh.nodes(1, j)));
        loads[i] += half;
        loads[j] += half;
      }
    }
  return loads;
}

std::vector<char> boundary_nodes(const TetMesh& mesh) {
  std::vector<char> on(static_cast<std::size_t>(mesh.nodes.cols()), 0);
  for (int node : mesh::boundary(mesh).node_of_vertex) on[static_cast<std::size_t>(node)] = 1;
  return on;
}

}  // namespace palpate::validation
