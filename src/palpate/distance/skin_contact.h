#pragma once
#include <array>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "palpate/distance/own_neighbourhood.h"
#include "palpate/distance/points.h"
#include "palpate/distance/surface.h"

namespace palpate::distance {

class LaneSearch;

/// Parameters of the contact between two skins, fixed at assembly.
struct SkinContactSpec {
  double stiffness_pa_m = 0.0;
  /// of each skin's points [m], see contact_points()
  std::array<double, 2> spacing_m = {std::numeric_limits<double>::infinity(),
                                     std::numeric_limits<double>::infinity()};
  bool two_sided = true;  ///< points of both skins, with half of the stiffness each; else of the first alone
};

/// How a skin touches itself.
struct OwnContact {
  OwnNeighbourhood neighbours;
  /// Whether the skin has come into tissue at a point x, which lies behind its foot: false where the body
  /// itself is that thin.
  std::function<bool(const ContactPoint& point, const Vec3& x, const Foot& foot)> is_overlap;
  /// Overlaps up to this are found [m].  Parts of the skin that are r apart along it come as near as r/2 to
  /// each other when the body is squeezed to half: nearer than that is contact.
  double depth() const { return 0.5 * neighbours.radius(); }
};

/// How far outside points of a skin against itself are worth keeping: those that may touch within a time at
/// the speed at which each approaches its foot.  Limbs move at different speeds: one bound for all would keep
/// all that is near to another part of the skin.
struct Approach {
  const double* velocities = nullptr;  ///< x y z of each node [m/s]; null: nothing moves
  double gap_m = 0.0;                  ///< kept in any case
  double time_s = 0.0;
};

/// A point of one skin, tied to its nearest point on the other.  It has a force while one of its triangles
/// overlaps the other skin.
struct Spring {
  int side = 0;                 ///< skin that the point belongs to
  int point = 0;                ///< number of the point
  int face = -1;                ///< of the other skin
  Vec3 weights = Vec3::Zero();  ///< of the face's corners
  Vec3 reach = Vec3::Zero();    ///< from the point to its foot, y - x [m]
  double gap = 0.0;             ///< signed distance of the point: -|y - x| inside, |y - x| outside [m]
  double stiffness = 0.0;  ///< k times the area of its hat that overlaps; of all of it where none does [N/m]
  double force = 0.0;      ///< k times the integral of overlap times hat [N]
  /// half of the overlap at the point times its force, triangle by triangle: U is their sum, for it is
  /// homogeneous of degree 2 in the overlaps [J]
  double energy = 0.0;
  double clear = 0.0;      ///< way of the skins up to which the point lies outside [m]
  bool is_placed = false;  ///< its foot is where it is nearest now; else nothing overlaps here
};

/// Resultant of all springs on the first skin.
struct Resultant {
  Vec3 force = Vec3::Zero();   ///< [N]
  Vec3 moment = Vec3::Zero();  ///< about the origin [N m]
};

/// Contact of two closed skins as an energy of distances.  With x the material points of a skin, y(x) the
/// nearest point of the other one, d(x) = -|x - y| inside it and |x - y| outside, and I d the function that
/// is linear on each triangle between the points and equal to d at them,
///
///     U = 1/2 integral_A k/2 ((-I d)+)^2 dA + 1/2 integral_B k/2 ((-I d)+)^2 dA      (two-sided; else A's
///     whole),
///
/// over the area at rest, exactly (linear_gap.h): where the other surface is a plane U is exact, however
/// coarse the triangles, at edges and corners too.  y minimises |x - y|, so that d's derivative leaves y's
/// weights alone (envelope theorem) and the force is the exact gradient: along the line through x and y, k
/// times the integral of overlap times the point's hat; the opposite on the foot's three corners.  It is
/// continuous, and changes its slope continuously where triangles come to overlap.  A sphere of radius R
/// pressed by delta into a half-space gives k pi R delta^2 to first order in delta/R (Sherman, Seth, Delp
/// 2011, whose elastic foundation this is, per area).
///
/// Where triangles stand for a curved surface (fit_to_surface()), d is lowered by how far it lies above them.
/// On triangles with edges e, against a surface of mean curvature H, I d is above d by H sum e^2/24 in the
/// mean: quadrature_error() says what that makes.
///
/// A skin may touch itself: both skins are the same one then, the points are those of the first, with half of
/// the stiffness, and the nearest point is sought among what is no neighbour of the point (OwnContact).
///
/// Everything is a function of the positions in the last find(), bitwise, whatever was found before; sums are
/// taken in a fixed order; nothing is allocated after construction.
class SkinContact {
 public:
  /// @param a, b  outlive the contact
  SkinContact(const Skin& a, const Skin& b, const SkinContactSpec& spec);
  /// @param meshes  of both skins; with half of the stiffness each, unless one is empty [Pa/m]
  SkinContact(const Skin& a, const Skin& b, double stiffness, std::array<ContactMesh, 2> meshes);
  /// A skin against itself: both positions of nodes are the same.
  SkinContact(const Skin& skin, double stiffness, ContactMesh mesh, OwnContact own);
  ~SkinContact();
  SkinContact(const SkinContact&) = delete;
  SkinContact& operator=(const SkinContact&) = delete;

  /// Finds the springs: of all points inside, of those outside that are nearer than `near`, and of all that
  /// share a triangle with one of these.
  /// @param nodes_a, nodes_b  x y z of each node [m]  @param near  [m]
  void find(const double* nodes_a, const double* nodes_b, double near = 0.0);
  /// Finds those of a skin against itself.  @param near  bound on all that is kept outside [m]
  void find_own(const double* nodes, double near, const Approach& approach);
  /// Moves the springs' feet to where they are nearest at other positions: what find() would give for these
  /// points.  No spring comes or goes, but gaps may change their sign.  A point that cannot have come inside
  /// yet, for it was farther outside than the skins have moved against each other since, is looked at only
  /// where a triangle of it overlaps: see Spring::is_placed.
  void follow(const double* nodes_a, const double* nodes_b);
  /// Finds them by Surface::nearest alone, point by point in double precision: what find() is tested against.
  void find_by_reference(const double* nodes_a, const double* nodes_b);

  const std::vector<Spring>& springs() const { return springs_; }
  const std::vector<ContactPoint>& points(int side) const {
    return meshes_[static_cast<std::size_t>(side)].points;
  }
  /// Whether faces of two clusters of a skin against itself are no neighbours.
  bool may_touch(int cluster, int other) const { return own_->neighbours.may_touch(cluster, other); }
  Vec3 position(const Spring& spring) const;  ///< of its point [m]
  /// The direction that leads out of the other skin at the spring's foot, unit: away from the nearest point
  /// outside and towards it inside, and the pseudonormal of Surface::outward() where the two coincide.
  Vec3 outward(const Spring& spring) const;
  const Surface& surface(int side) const { return surfaces_[side]; }
  /// As Surface::spread(), of one side.
  double spread(int side, const double* node_velocities, const Vec3& about) const {
    return surfaces_[side].spread(node_velocities, about);
  }
  double energy() const;                             ///< U [J]
  double deepest() const;                            ///< largest |x - y| [m]
  void add_force(double* nodes_a, double* nodes_b);  ///< adds -dU/dq to x y z of each node [N]
  Resultant resultant() const;
  double force_sum() const;      ///< of all springs' forces [N]
  double largest_force() const;  ///< of one spring [N]
  /// Estimates by how much the forces are off because gaps and normals are taken as linear on triangles: the
  /// sum over all that overlap of what each misses (missed_by_linear()), whatever its direction [N].
  double quadrature_error() const;

 private:
  SkinContact(const Skin& a, const Skin& b, double stiffness, std::array<ContactMesh, 2> meshes,
              std::optional<OwnContact> own);
  static constexpr int kPacket = 16;  ///< points that are searched for together

  void move(const double* nodes_a, const double* nodes_b);
  bool is_searchable() const;
  const ContactTriangle& triangle(int side, int number) const {
    return meshes_[static_cast<std::size_t>(side)].triangles[static_cast<std::size_t>(number)];
  }
  void find_triangles();
  void merge_added();
  void list_missing();
  void integrate();
  template <class Visit>
  void for_each_overlap(const Visit& visit) const;
  void find_side(int side, double near);
  void find_clusters_of_own(double near);
  void mark_near_itself();
  bool may_come_near(const ContactPoint& point, const Foot& foot) const;
  void follow_packets(const std::vector<std::size_t>& springs);
  void follow_packet(std::span<const std::size_t> springs);
  void find_side_by_reference(int side);
  struct Part {
    int cluster, tree_node;
  };
  void settle(int side, const Part& part);
  double gap_of(int side, const Eigen::AlignedBox3d& box, double near, int& near_leaf) const;
  const OwnNeighbourhood* neighbours() const { return own_ ? &own_->neighbours : nullptr; }
  bool overlaps(const ContactPoint& point, const Vec3& x, const Foot& foot) const;
  int find_cluster(int side, int cluster, int start, double near);
  void add_spring(int side, int point, const Foot& foot, bool is_inside);
  void set_foot(Spring& spring, const Foot& foot, bool is_inside) const;
  Vec3 position(int side, const ContactPoint& point) const;
  void add_to_vertices(const Spring& spring, const Vec3& force);
  void add_to_nodes(double* nodes_a, double* nodes_b);

  std::optional<OwnContact> own_;  ///< of a skin against itself
  Approach approach_;
  double stiffness_;  ///< of the points of one side [Pa/m]
  Surface surfaces_[2];
  std::array<ContactMesh, 2> meshes_;
  double most_lowered_[2] = {0.0, 0.0};  ///< of each side's triangles [m]
  std::vector<int> cluster_points_[2];   ///< first point of each cluster's faces, and the number of all
  std::vector<Spring> springs_;
  /// Triangles with a spring at each corner.
  struct Triangle {
    int side = 0, number = 0;
    std::array<int, 3> spring{};
  };
  std::vector<Triangle> triangles_;  ///< by side and number
  std::vector<Spring> added_;        ///< at corners of triangles whose points were not found
  std::vector<int> spring_of_[2];    ///< of each point; -1: none
  std::vector<char> is_near_[2];     ///< triangles of `triangles_`

  // Bounds on the search, which change its time and no result.
  std::unique_ptr<LaneSearch> searches_[2];        ///< for nearest points of each skin
  std::vector<int> starts_[2];                     ///< face that was near each cluster
  std::vector<std::array<int, kPacket>> feet_[2];  ///< faces that were nearest to each packet, -1 at the end
  std::vector<int> first_packet_[2];               ///< of each cluster
  double travelled_ = 0.0;                ///< bound on how far the skins have moved against each other [m]
  std::vector<double> clear_[2];          ///< value of `travelled_` up to which each cluster lies outside
  std::vector<double> packets_clear_[2];  ///< and each packet
  enum class Whereabouts : char { kOutside, kInside, kWhole, kNear };  ///< kWhole: one of the first two
  std::vector<Whereabouts> where_[2];                                  ///< of each cluster
  std::vector<Part> whole_;
  std::vector<int> joined_;
  std::vector<std::size_t> missing_;  ///< springs that are to be placed
  struct Scratch;
  std::unique_ptr<Scratch> scratch_;

  struct VertexForces {
    Points sum;  ///< zero between calls
    std::vector<char> is_touched;
    std::vector<int> touched;  ///< vertices in the order in which springs met them
  };
  VertexForces vertex_forces_[2];
};

}  // namespace palpate::distance
