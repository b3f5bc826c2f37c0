/// Driven directions, prescribed by functions of time or carried by a master: their elimination from the
/// equations of motion, and their contribution to the masters' equations.
#include "palpate/core/error.h"
#include "palpate/dynamics/system.h"

namespace palpate::dynamics {

void System::evaluate_driven(const StateView& state) const {
  for (Driven& d : driven_) {
    const auto n = static_cast<Eigen::Index>(d.motion->dofs().size());
    d.x.resize(n);
    d.v.resize(n);
    d.a.resize(n);
    d.motion->evaluate(state, d.x, d.v, d.a);
    if (d.master_offset < 0) continue;
    d.G.resize(n, d.master_size);
    d.motion->jacobian(state, d.G);
  }
}

void System::impose(const Layout& layout, double t, double* q, double* u) const {
  if (driven_.empty()) return;
  evaluate_driven(make_view(layout, t, q, u));
  for (const Driven& d : driven_) {
    const auto& dofs = d.motion->dofs();
    // Node blocks come first with q' = u: one index is valid for both.
    for (std::size_t i = 0; i < dofs.size(); ++i) {
      q[dofs[i]] = d.x[static_cast<Eigen::Index>(i)];
      u[dofs[i]] = d.v[static_cast<Eigen::Index>(i)];
    }
  }
}

// The force of carried nodes on their master, c = f - M u', rotates with it. It is evaluated with u' of the
// present state: a body in free fall exerts no force, and for a light master the forces and moments c are in
// balance, which makes K symmetric.
void System::evaluate_carried_stiffness(const StateView& state, const TermFilter& filter) {
  force(state, held_scratch_, filter);
  force_scratch_ = held_scratch_;
  acceleration_of_force(state, force_scratch_, acceleration_scratch_);
  apply_mass(state, acceleration_scratch_, scratch_);
  held_scratch_ -= scratch_;
  for (Driven& d : driven_) {
    if (d.master_offset < 0) continue;
    const auto& dofs = d.motion->dofs();
    d.c.resize(static_cast<Eigen::Index>(dofs.size()));
    for (std::size_t i = 0; i < dofs.size(); ++i) d.c[static_cast<Eigen::Index>(i)] = held_scratch_[dofs[i]];
    d.K.setZero(d.master_size, d.master_size);
    d.motion->add_geometric_stiffness(state, d.c, d.K);
  }
}

void System::apply_carried_stiffness(const StateView& state, const VecX& x, VecX& y,
                                     const TermFilter& filter) {
  if (!any_master_) return;
  evaluate_carried_stiffness(state, filter);
  for (const Driven& d : driven_)
    if (d.master_offset >= 0)
      y.segment(d.master_offset, d.master_size) += d.K * x.segment(d.master_offset, d.master_size);
}

// T^T A T with T = [P Ghat; 0 I]: the driven columns, carried by their master, are added to its columns, and
// the driven rows to its rows.
//     right' = right + B G,   corner' = corner + G^T right' + bottom G,   bottom' = bottom + (B^T G)^T,
// over the rows of the carried directions only. B has a symmetric pattern: column j of nodes is read along
// row j.
void System::reduce_to_masters(const StateView& state, BorderedMatrix& A) const {
  using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  const auto each_carried = [&](auto&& visit) {  // (direction, first border column of its master, row of G)
    for (const Driven& d : driven_)
      for (std::size_t i = 0; d.master_offset >= 0 && i < d.motion->dofs().size(); ++i)
        visit(d.motion->dofs()[i], d.master_offset - state.layout->nodal_size,
              d.G.row(static_cast<Eigen::Index>(i)));
  };
  each_carried(
      [&](int dof, int at, const auto& g) { A.corner.middleCols(at, g.size()) += A.bottom.col(dof) * g; });
  each_carried([&](int dof, int at, const auto& g) {
    const int node = dof / 3, axis = dof % 3;
    for (int s = A.body.row_start()[static_cast<std::size_t>(node)];
         s < A.body.row_start()[static_cast<std::size_t>(node) + 1]; ++s) {
      const int other = A.body.columns()[static_cast<std::size_t>(s)];
      const Vec3 row = Eigen::Map<const RowMajor3>(A.body.block(s)).row(axis);
      const Vec3 column =
          A.symmetric ? row
                      : Vec3(Eigen::Map<const RowMajor3>(A.body.block(A.body.slot(other, node))).col(axis));
      A.right.block(3 * other, at, 3, g.size()) += column * g;
      A.bottom.block(at, 3 * other, g.size(), 3) += g.transpose() * row.transpose();
    }
  });
  each_carried([&](int dof, int at, const auto& g) {
    A.corner.middleRows(at, g.size()) += g.transpose() * A.right.row(dof);
  });
}

void System::find_driven_slots(const BlockSparse& A) const {
  driven_mirrors_.clear();
  for (const HeldNode& d : driven_nodes_)
    for (int s = A.row_start()[static_cast<std::size_t>(d.node)];
         s < A.row_start()[static_cast<std::size_t>(d.node) + 1]; ++s)
      driven_mirrors_.push_back(A.slot(A.columns()[static_cast<std::size_t>(s)], d.node));
  driven_pattern_ = A.pattern_version();
}

void System::eliminate_driven(BorderedMatrix& A) const {
  if (driven_pattern_ != A.body.pattern_version()) find_driven_slots(A.body);
  std::size_t mirror = 0;
  for (const HeldNode& d : driven_nodes_) {
    for (int s = A.body.row_start()[static_cast<std::size_t>(d.node)];
         s < A.body.row_start()[static_cast<std::size_t>(d.node) + 1]; ++s, ++mirror) {
      double *block = A.body.block(s), *mirrored = A.body.block(driven_mirrors_[mirror]);
      for (int axis = 0; axis < 3; ++axis) {
        if (!d.axes[static_cast<std::size_t>(axis)]) continue;
        for (int c = 0; c < 3; ++c) block[3 * axis + c] = mirrored[3 * c + axis] = 0.0;
      }
    }
    double* own = A.body.block(A.body.diagonal(d.node));
    for (int axis = 0; axis < 3; ++axis)
      if (d.axes[static_cast<std::size_t>(axis)]) own[4 * axis] = 1.0;
  }
  if (A.border_size() == 0) return;
  for (int dof : driven_dofs_) {
    A.right.row(dof).setZero();
    A.bottom.col(dof).setZero();
  }
}

void System::reduce(const StateView& state, VecX& r) const {
  if (any_master_) {
    evaluate_driven(state);
    for (const Driven& d : driven_) {
      if (d.master_offset < 0) continue;
      for (std::size_t i = 0; i < d.motion->dofs().size(); ++i)
        r.segment(d.master_offset, d.master_size) +=
            d.G.row(static_cast<Eigen::Index>(i)).transpose() * r[d.motion->dofs()[i]];
    }
  }
  for (int dof : driven_dofs_) r[dof] = 0.0;
}

void System::expand(const StateView& state, VecX& x) const {
  for (int dof : driven_dofs_) x[dof] = 0.0;
  if (!any_master_) return;
  evaluate_driven(state);
  for (const Driven& d : driven_)
    for (std::size_t i = 0; d.master_offset >= 0 && i < d.motion->dofs().size(); ++i)
      x[d.motion->dofs()[i]] =
          d.G.row(static_cast<Eigen::Index>(i)).dot(x.segment(d.master_offset, d.master_size));
}

void System::reactions(const StateView& state, VecX& r) {
  VecX f, a, given;
  force(state, f);
  given = f;
  acceleration_of_force(state, given, a);
  apply_mass(state, a, r);
  r -= f;
  for (Eigen::Index i = 0; i < r.size(); ++i)
    if (!driven_mask_[static_cast<std::size_t>(i)]) r[i] = 0.0;
}

double System::support_power(const StateView& state) {
  if (std::none_of(driven_.begin(), driven_.end(), [](const Driven& d) { return d.master_offset < 0; }))
    return 0.0;
  VecX r;
  reactions(state, r);
  double sum = 0.0;
  for (const Driven& d : driven_)
    if (d.master_offset < 0)
      for (const int dof : d.motion->dofs()) sum += r[dof] * state.u[dof];
  return sum;
}

}  // namespace palpate::dynamics
