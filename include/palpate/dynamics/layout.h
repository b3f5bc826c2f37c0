#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "palpate/core/types.h"

namespace palpate::dynamics {

/// What a block stands for: nodes of a mesh, a free rigid body, or a tree of bodies on joints.
enum class BlockKind { kNodes, kRigidBody, kArticulated };

/// a part of a vector, to be written
using Segment = Eigen::Ref<VecX>;
/// a part of a vector, to be read
using ConstSegment = Eigen::Ref<const VecX>;

/// How the coordinates of one block follow from its velocities: q' = N(q) u.  Node blocks have none (N = I).
class BlockKinematics {
 public:
  virtual ~BlockKinematics() = default;
  /// q_dot = N(q) u; sizes q_size, u_size and q_size of the block.
  virtual void q_dot(const ConstSegment& q, const ConstSegment& u, Segment q_dot) const = 0;
  /// Left inverse of N: the u whose q_dot this is.
  virtual void u_of_q_dot(const ConstSegment& q, const ConstSegment& q_dot, Segment u) const = 0;
  /// Back onto the manifold (unit quaternions).  Called after accepted steps, never inside a right-hand side.
  virtual void project(Segment q) const = 0;
};

/// Free rigid body: q = (qw qx qy qz px py pz), u = (angular, linear) in world axes; q_w' = 1/2 (0, angular)
/// * q_w.
std::shared_ptr<const BlockKinematics> free_body_kinematics();

/// One block of the State before it has its place: sizes, scales of errors, kinematics.
struct BlockSpec {
  std::string name;                    ///< unique in the State
  BlockKind kind = BlockKind::kNodes;  ///< of a node block: u = q'
  int q_size = 0;                      ///< number of its coordinates
  int u_size = 0;                      ///< number of its velocities
  /// size of a q that matters (a body's displacement, [m]): the unit of its absolute tolerance
  double q_scale = 1.0;
  double u_scale = 1.0;                                 ///< size of a u that matters [m/s]
  std::shared_ptr<const BlockKinematics> kinematics{};  ///< null: q' = u
  /// One entry a q and a u: whether it is an angle (or belongs to a quaternion), whose scale is 1, or an
  /// angular rate, whose scale is u_scale / q_scale.  Empty: none.
  std::vector<char> angles_q{}, angles_u{};
};

/// One block's place in q and u.
struct Block : BlockSpec {
  int id = -1;       ///< stable for the life of the State; never used again after removal
  int q_offset = 0;  ///< where its coordinates start in q
  int u_offset = 0;  ///< where its velocities start in u
};

/// The order of the blocks: node blocks first (their u are the rows of the sparse part of every matrix),
/// then rigid and articulated ones (the border).  `version` grows with every insertion and removal.
struct Layout {
  std::vector<Block> blocks;  ///< in their order
  int q_size = 0;             ///< coordinates of all blocks
  int u_size = 0;             ///< velocities of all blocks
  int nodal_size = 0;         ///< number of u in node blocks: three a node
  std::uint64_t version = 0;  ///< see above

  /// Nodes of all node blocks.
  int node_count() const { return nodal_size / 3; }
  /// Velocities of rigid and articulated blocks.
  int border_size() const { return u_size - nodal_size; }
  const Block* find(int id) const;  ///< null when there is none
  /// The first of that name; null when there is none.
  const Block* find(const std::string& name) const;
};

}  // namespace palpate::dynamics
