#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "palpate/core/types.h"

namespace palpate::dynamics {

/// Kind of a block: nodes of a mesh, a free rigid body, or a tree of bodies on joints.
enum class BlockKind { kNodes, kRigidBody, kArticulated };

/// Writable part of a vector.
using Segment = Eigen::Ref<VecX>;
/// Read-only part of a vector.
using ConstSegment = Eigen::Ref<const VecX>;

/// Kinematics of one block: q' = N(q) u maps its velocities to the rates of its coordinates. Node blocks have
/// none (N = I).
class BlockKinematics {
 public:
  virtual ~BlockKinematics() = default;
  /// Computes q_dot = N(q) u; q has q_size, u has u_size and q_dot has q_size entries of the block.
  virtual void q_dot(const ConstSegment& q, const ConstSegment& u, Segment q_dot) const = 0;
  /// Computes the u that yields this q_dot (left inverse of N).
  virtual void u_of_q_dot(const ConstSegment& q, const ConstSegment& q_dot, Segment u) const = 0;
  /// Projects q back onto the manifold (unit quaternions). Called after accepted steps, never inside a
  /// right-hand side.
  virtual void project(Segment q) const = 0;
};

/// Returns the kinematics of a free rigid body: q = (qw qx qy qz px py pz), u = (angular, linear) in world
/// axes; q_w' = 1/2 (0, angular) * q_w, with q_w the quaternion.
std::shared_ptr<const BlockKinematics> free_body_kinematics();

/// Description of a block before it is placed in a State: sizes, error scales, kinematics.
struct BlockSpec {
  std::string name;                    ///< Name, unique in the State.
  BlockKind kind = BlockKind::kNodes;  ///< Kind; a node block has u = q'.
  int q_size = 0;                      ///< Number of coordinates.
  int u_size = 0;                      ///< Number of velocities.
  /// Characteristic magnitude of q (a body's displacement, [m]): unit of its absolute tolerance.
  double q_scale = 1.0;
  double u_scale = 1.0;                                 ///< Characteristic magnitude of u [m/s].
  std::shared_ptr<const BlockKinematics> kinematics{};  ///< null: q' = u
  /// One entry per q and per u: whether it is an angle (or belongs to a quaternion), with scale 1, or an
  /// angular rate, with scale u_scale / q_scale. Empty: none.
  std::vector<char> angles_q{}, angles_u{};
};

/// Block of a State with its place in q and u.
struct Block : BlockSpec {
  int id = -1;       ///< Stable for the life of the State; not reused after removal.
  int q_offset = 0;  ///< Index of its first coordinate in q.
  int u_offset = 0;  ///< Index of its first velocity in u.
};

/// Order of the blocks: node blocks first (their u are the rows of the sparse part of every matrix), then
/// rigid and articulated ones (the border).
struct Layout {
  std::vector<Block> blocks;  ///< All blocks, in this order.
  int q_size = 0;             ///< Number of coordinates of all blocks.
  int u_size = 0;             ///< Number of velocities of all blocks.
  int nodal_size = 0;         ///< Number of u in node blocks: three per node.
  std::uint64_t version = 0;  ///< Increases with every insertion and removal.

  /// Returns the number of nodes of all node blocks.
  int node_count() const { return nodal_size / 3; }
  /// Returns the number of velocities of rigid and articulated blocks.
  int border_size() const { return u_size - nodal_size; }
  const Block* find(int id) const;  ///< Returns the block with this id; null when there is none.
  /// Returns the first block with this name; null when there is none.
  const Block* find(const std::string& name) const;
};

}  // namespace palpate::dynamics
