#pragma once
#include "palpate/dynamics/layout.h"

namespace palpate::dynamics {

/// What a force term sees: time, coordinates and velocities, not owned.  Integrators hand out views of their
/// own vectors, so nothing is copied.
struct StateView {
  const Layout* layout = nullptr;        ///< what stands where in q and u
  double time = 0.0;                     ///< [s]
  Eigen::Map<const VecX> q{nullptr, 0};  ///< coordinates of all blocks; of nodes, positions [m]
  Eigen::Map<const VecX> u{nullptr, 0};  ///< velocities of all blocks; of nodes [m/s]

  Vec3 position(int node) const { return q.segment<3>(3 * node); }  ///< node counted over all node blocks
  /// node counted over all node blocks
  Vec3 velocity(int node) const { return u.segment<3>(3 * node); }
};

/// Owns q and u of all blocks.  Storage is reserved once, so that inserting and extracting blocks within the
/// capacity allocates no vector storage.
class State {
 public:
  /// @param q_capacity, u_capacity, block_capacity  sizes that are reserved; it grows beyond them
  explicit State(int q_capacity = 0, int u_capacity = 0, int block_capacity = 8);

  /// Adds a block, nodes before bodies; returns its id.  @throws InternalError when sizes do not fit.
  int insert(const BlockSpec& spec, const ConstSegment& q, const ConstSegment& u);
  /// Takes a block out; its q and u are copied to the arguments (sized by the caller or resized).
  BlockSpec extract(int id, VecX& q, VecX& u);

  /// Which blocks there are, and where.
  const Layout& layout() const { return layout_; }
  /// [s]
  double time() const { return time_; }
  /// The coordinates stay as they are.
  void set_time(double t) { time_ = t; }

  /// All coordinates.
  Eigen::Map<VecX> q() { return {q_.data(), layout_.q_size}; }
  /// All velocities.
  Eigen::Map<VecX> u() { return {u_.data(), layout_.u_size}; }
  /// All coordinates.
  Eigen::Map<const VecX> q() const { return {q_.data(), layout_.q_size}; }
  /// All velocities.
  Eigen::Map<const VecX> u() const { return {u_.data(), layout_.u_size}; }
  /// The coordinates of one block.
  Eigen::Map<VecX> q(const Block& b) { return {q_.data() + b.q_offset, b.q_size}; }
  /// The velocities of one block.
  Eigen::Map<VecX> u(const Block& b) { return {u_.data() + b.u_offset, b.u_size}; }

  /// Of its own vectors, valid until blocks come or go.
  StateView view() const { return view(time_, q_.data(), u_.data()); }
  /// A view of somebody else's vectors in this layout (an integrator's trial state).
  StateView view(double t, const double* q, const double* u) const;

 private:
  Layout layout_;
  double time_ = 0.0;
  std::vector<double> q_, u_;
  int next_id_ = 0;
};

/// A view of vectors that stand in this layout's order.
StateView make_view(const Layout& layout, double t, const double* q, const double* u);

/// q_dot = N(q) u for all blocks; sizes layout.q_size and layout.u_size.
void q_dot(const Layout& layout, const double* q, const double* u, double* q_dot);
/// Normalises what has to be (quaternions).
void project(const Layout& layout, double* q);

}  // namespace palpate::dynamics
