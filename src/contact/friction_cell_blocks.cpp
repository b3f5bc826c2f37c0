// What the sums of a cell (friction_cells.cpp, whose derivation gives the names) are on nodes.
#include <cmath>

#include "contact/friction_cells.h"
#include "palpate/core/error.h"

namespace palpate::contact {

void FrictionCells::add_step_force(VecX& f) {
  sum();
  for (const Cell& cell : cells_)
    for (std::size_t i = 0; cell.first < cell.last && i < static_cast<std::size_t>(cell.count); ++i)
      f.segment<3>(3 * cell.node[i]) += cell.axes * cell.f.row(cell.at[i]).transpose();
}

void FrictionCells::apply_tangent(double k_scale, double d_scale, const VecX& x, VecX& y) {
  sum();
  for (const Cell& cell : cells_) {
    if (cell.first == cell.last) continue;
    const Three moved = on_nodes(cell, x);
    Three out;
    out.col(0) = k_scale * (cell.k * moved.col(0)) + d_scale * (cell.d * moved.col(0));
    out.col(1) = d_scale * (cell.d11 * moved.col(1) + cell.d12 * moved.col(2));
    out.col(2) = d_scale * (cell.d12 * moved.col(1) + cell.d22 * moved.col(2));
    for (std::size_t i = 0; i < static_cast<std::size_t>(cell.count); ++i)
      y.segment<3>(3 * cell.node[i]) += cell.axes * out.row(cell.at[i]).transpose();
  }
}

void FrictionCells::add_tangent(double k_scale, double d_scale, dynamics::BorderedMatrix& A) {
  sum();
  for (const Cell& cell : cells_)
    for (std::size_t i = 0; cell.first < cell.last && i < static_cast<std::size_t>(cell.count); ++i)
      for (std::size_t j = 0; j < static_cast<std::size_t>(cell.count); ++j) {
        const int p = cell.at[i], q = cell.at[j], slot = A.body.slot(cell.node[i], cell.node[j]);
        PALPATE_CHECK(slot >= 0,
                      "contact couples nodes {} and {}, which its source did not announce in add_pattern",
                      cell.node[i], cell.node[j]);
        Mat3 along = Mat3::Zero();
        along(0, 0) = k_scale * cell.k(p, q) + d_scale * cell.d(p, q);
        along(1, 1) = d_scale * cell.d11(p, q);
        along(2, 2) = d_scale * cell.d22(p, q);
        along(1, 2) = along(2, 1) = d_scale * cell.d12(p, q);
        A.body.add(slot, cell.axes * along * cell.axes.transpose());
      }
}

// e_1 e_2^T + e_2 e_1^T = 2 e e^T - e_1 e_1^T - e_2 e_2^T  with e = (e_1 + e_2)/sqrt(2).
void FrictionCells::add_stiffness(double k_scale, double d_scale, dynamics::PointStiffness& C) {
  sum();
  for (const Cell& cell : cells_) {
    if (cell.first == cell.last) continue;
    const auto add = [&](const Vec3& along, const Mat8& of_y) {
      dynamics::PointStiffness::AlongNormal& out = C.along.emplace_back();
      out.normal = along;
      out.nodes.relative = cell.frame < 0;
      out.nodes.count = cell.count;
      for (int i = 0; i < cell.count; ++i) {
        out.nodes.node[static_cast<std::size_t>(i)] = cell.node[static_cast<std::size_t>(i)];
        for (int j = 0; j < cell.count; ++j)
          out.G(i, j) = of_y(cell.at[static_cast<std::size_t>(i)], cell.at[static_cast<std::size_t>(j)]);
      }
    };
    const Vec3 e1 = cell.axes.col(1), e2 = cell.axes.col(2);
    add(cell.axes.col(0), k_scale * cell.k + d_scale * cell.d);
    add(e1, d_scale * (cell.d11 - cell.d12));
    add(e2, d_scale * (cell.d22 - cell.d12));
    add(std::sqrt(0.5) * (e1 + e2), 2.0 * d_scale * cell.d12);
  }
}

}  // namespace palpate::contact
