#include "pressed_block.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "palpate/core/error.h"
#include "palpate/mesh/boundary.h"
#include "palpate/mesh/generators.h"
#include "statics.h"

namespace palpate::validation {

double BlockMesh::half_width() const { return inner * std::sinh(doublings * std::log(2.0)); }

double BlockMesh::smallest_cell() const { return inner * std::sinh(std::log(2.0) / per_doubling); }

namespace {

/// Returns the unit cube with six tetrahedra per cell around its diagonal (Kuhn 1960). On the top, cells
/// on x = y are cut along it: when the mesh is made round, two of their edges are nearly collinear, and a cut
/// across would leave a flat triangle.
TetMesh cut_along_diagonals(int n) {
  const auto node = [n](const std::array<int, 3>& i) { return i[0] + (n + 1) * (i[1] + (n + 1) * i[2]); };
  TetMesh mesh;
  mesh.nodes.resize(3, (n + 1) * (n + 1) * (n + 1));
  mesh.tets.resize(4, 6 * n * n * n);
  Eigen::Index next = 0;
  for (int z = 0; z <= n; ++z)
    for (int y = 0; y <= n; ++y)
      for (int x = 0; x <= n; ++x) {
        mesh.nodes.col(node({x, y, z})) = Vec3(x, y, z) / n;
        if (std::max({x, y, z}) == n) continue;
        std::array<int, 3> axes{0, 1, 2};
        do {
          std::array<int, 3> at{x, y, z};
          Eigen::Vector4i tet;
          tet[0] = node(at);
          for (int k = 0; k < 3; ++k) {
            ++at[static_cast<std::size_t>(axes[static_cast<std::size_t>(k)])];
            tet[k + 1] = node(at);
          }
          const bool even = (axes[1] - axes[0] + 3) % 3 == 1;  // Positive volume.
          if (!even) std::swap(tet[1], tet[2]);
          mesh.tets.col(next++) = tet;
        } while (std::next_permutation(axes.begin(), axes.end()));
      }
  return mesh;
}

}  // namespace

TetMesh BlockMesh::tets() const {
  const int n = per_doubling * doublings, across = shape == BlockShape::kWhole ? 2 * n : n;
  const double tau = std::log(2.0) / per_doubling, first = shape == BlockShape::kWhole ? -n : 0;
  const auto graded = [&](double cell) { return inner * std::sinh(std::round(cell) * tau); };
  TetMesh mesh;
  if (shape == BlockShape::kRoundQuarter) {
    mesh = cut_along_diagonals(n);
  } else {
    mesh = mesh::box(Vec3::Ones(), {across, across, n});
    mesh.nodes.array() += 0.5;
  }
  for (auto x : mesh.nodes.colwise()) {
    x = Vec3(graded(first + across * x.x()), graded(first + across * x.y()), -graded(n - n * x.z()));
    const double from_axis = x.head<2>().norm();
    if (shape == BlockShape::kRoundQuarter && from_axis > 0.0)
      x.head<2>() *= x.head<2>().maxCoeff() / from_axis;
  }
  return mesh;
}

double indentation_force(const BlockMesh& mesh, const fem::Material& material, double stiffness_pa_m,
                         const MakeIndenter& indenter) {
  constexpr int kQueries = 100;  // With material points each query reduces the error by a quarter to a half.
  constexpr double kSettled = 1e-6;  // Relative change of the force from one query to the next.
  const double parts = mesh.shape == BlockShape::kWhole ? 1.0 : 4.0;
  const TetMesh rest = mesh.tets();
  const double small = 1e-3 * mesh.smallest_cell(), bottom = small - mesh.half_width();
  StaticBody body(rest, material);
  for (int i = 0; i < rest.nodes.cols(); ++i) {
    const Vec3 x = rest.nodes.col(i);
    if (x.z() < bottom) {
      body.hold(i, x);
      continue;
    }
    for (int axis : {0, 1})
      if (std::abs(x[axis]) < small) body.hold(i, axis, 0.0);
  }
  const auto motion = contact::fixed_frame();
  const auto contact = std::make_shared<contact::ContactForce>();
  contact->add_frame(motion);
  ContactSpec law;
  law.stiffness_pa_m = stiffness_pa_m;
  const mesh::Boundary boundary = mesh::boundary(rest);
  body.add([&](int block_id) {
    contact->add_pair(indenter({block_id, boundary.node_of_vertex, boundary.surface.faces}, 0, motion), law);
    return contact;
  });
  double before = 0.0;
  for (int i = 0; i < kQueries; ++i) {
    contact->refresh(body.view());
    if (!body.solve()) return std::nan("");
    const double force = parts * contact->frame_wrench(body.view(), 0).force.z();
    if (std::abs(force - before) <= kSettled * std::abs(force)) return force;
    before = force;
  }
  return std::nan("");
}

// With v = v0 + c h^p: (v1 - v2)/(v2 - v3) = (h1^p - h2^p)/(h2^p - h3^p), which grows with p: bisection.
Limit limit_of(const std::vector<double>& h, const std::vector<double>& value) {
  PALPATE_CHECK(h.size() == 3 && value.size() == 3, "{} sizes, {} values", h.size(), value.size());
  const double ratio = (value[0] - value[1]) / (value[1] - value[2]);
  const auto of = [&](double p) {
    return (std::pow(h[0], p) - std::pow(h[1], p)) / (std::pow(h[1], p) - std::pow(h[2], p));
  };
  double low = 0.05, high = 8.0;
  if (!(ratio > of(low) && ratio < of(high))) return {std::nan(""), std::nan("")};
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (of(middle) < ratio ? low : high) = middle;
  }
  const double p = 0.5 * (low + high), c = (value[1] - value[2]) / (std::pow(h[1], p) - std::pow(h[2], p));
  return {value[2] - c * std::pow(h[2], p), p};
}

double at_zero(const std::vector<double>& x, const std::vector<double>& value) {
  PALPATE_CHECK(x.size() == 3 && value.size() == 3, "{} places, {} values", x.size(), value.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    double weight = 1.0;
    for (std::size_t j = 0; j < 3; ++j)
      if (j != i) weight *= x[j] / (x[j] - x[i]);
    sum += weight * value[i];
  }
  return sum;
}

}  // namespace palpate::validation
