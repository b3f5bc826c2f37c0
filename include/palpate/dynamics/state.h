#pragma once
#include "palpate/dynamics/layout.h"

namespace palpate::dynamics {

/// Time, coordinates and velocities at which a force term is evaluated, not owned. Integrators pass views of
/// their vectors, so nothing is copied.
struct StateView {
  const Layout* layout = nullptr;        ///< Places of the blocks in q and u.
  double time = 0.0;                     ///< Time [s].
  Eigen::Map<const VecX> q{nullptr, 0};  ///< Coordinates of all blocks; of nodes, positions [m].
  Eigen::Map<const VecX> u{nullptr, 0};  ///< Velocities of all blocks; of nodes [m/s].

  /// Returns the position of a node [m]; nodes are numbered over all node blocks.
  Vec3 position(int node) const { return q.segment<3>(3 * node); }
  /// Returns the velocity of a node [m/s]; nodes are numbered over all node blocks.
  Vec3 velocity(int node) const { return u.segment<3>(3 * node); }
};

/// Owner of q and u of all blocks. Storage is reserved once, so that inserting and extracting blocks within
/// the capacity allocates no vector storage.
class State {
 public:
  /// @param q_capacity, u_capacity, block_capacity  reserved sizes; the State grows beyond them where needed
  explicit State(int q_capacity = 0, int u_capacity = 0, int block_capacity = 8);

  /// Inserts a new block and returns its id. Node blocks are placed before bodies. @throws InternalError when
  /// sizes do not fit.
  int insert(const BlockSpec& spec, const ConstSegment& q, const ConstSegment& u);
  /// Removes the block `id` and returns its description; its q and u are copied to the arguments, which are
  /// resized. @throws InternalError when there is no block with this id
  BlockSpec extract(int id, VecX& q, VecX& u);

  /// Returns the blocks and their places.
  const Layout& layout() const { return layout_; }
  /// Returns the time [s].
  double time() const { return time_; }
  /// Sets the time [s]; coordinates and velocities are unchanged.
  void set_time(double t) { time_ = t; }

  /// Returns all coordinates.
  Eigen::Map<VecX> q() { return {q_.data(), layout_.q_size}; }
  /// Returns all velocities.
  Eigen::Map<VecX> u() { return {u_.data(), layout_.u_size}; }
  /// Returns all coordinates.
  Eigen::Map<const VecX> q() const { return {q_.data(), layout_.q_size}; }
  /// Returns all velocities.
  Eigen::Map<const VecX> u() const { return {u_.data(), layout_.u_size}; }
  /// Returns the coordinates of one block.
  Eigen::Map<VecX> q(const Block& b) { return {q_.data() + b.q_offset, b.q_size}; }
  /// Returns the velocities of one block.
  Eigen::Map<VecX> u(const Block& b) { return {u_.data() + b.u_offset, b.u_size}; }

  /// Returns a view of this State, valid until blocks are added or removed.
  StateView view() const { return view(time_, q_.data(), u_.data()); }
  /// Returns a view of external vectors in this layout (an integrator's trial state).
  StateView view(double t, const double* q, const double* u) const;

 private:
  Layout layout_;
  double time_ = 0.0;
  std::vector<double> q_, u_;
  int next_id_ = 0;
};

/// Returns a view of vectors that are ordered by this layout.
StateView make_view(const Layout& layout, double t, const double* q, const double* u);

/// Computes q_dot = N(q) u of all blocks; sizes layout.q_size and layout.u_size.
void q_dot(const Layout& layout, const double* q, const double* u, double* q_dot);
/// Projects q onto the manifold: normalises the quaternions.
void project(const Layout& layout, double* q);

}  // namespace palpate::dynamics
