#pragma once
#include <array>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include "distance/own_neighbourhood.h"
#include "distance/points.h"
#include "distance/surface.h"

namespace palpate::distance {

/// Parameters of the contact between two skins, fixed at assembly.
struct SkinContactSpec {
  /// Contact stiffness k: pressure per overlap [Pa/m].
  double stiffness_pa_m = 0.0;
  /// Spacing of the contact points per skin [m], see contact_mesh(); infinite: vertices only.
  std::array<double, 2> spacing_m = {std::numeric_limits<double>::infinity(),
                                     std::numeric_limits<double>::infinity()};
  /// True: points of both skins, with half of the stiffness each. False: points of the first skin alone.
  bool two_sided = true;
};

/// Parameters of self-contact of a skin.
struct OwnContact {
  /// Pairs of clusters that are excluded from contact.
  OwnNeighbourhood neighbours;
  /// Returns whether a point x behind its foot overlaps another part of the skin; false where the body itself
  /// is that thin.
  std::function<bool(const ContactPoint& point, const Vec3& x, const Foot& foot)> is_overlap;
  /// Returns the largest overlap that is detected [m]. Parts of the skin that are r apart along it come
  /// within r/2 of each other when the body is squeezed to half its length; anything nearer than that is
  /// contact.
  double depth() const { return 0.5 * neighbours.radius(); }
};

/// Selects which outside points of a self-contact are kept: those that may touch within `time_s` at their
/// approach speed towards their feet. Limbs move at different speeds, so one bound for all points would keep
/// everything near another part of the skin.
struct Approach {
  /// Node velocities, x y z per node [m/s]; null: every point within `near` of find_own() is kept.
  const double* velocities = nullptr;
  double gap_m = 0.0;   ///< Points closer than this are always kept [m].
  double time_s = 0.0;  ///< Time until the next query [s].
};

/// Contact point of one skin, paired with its nearest point on the other skin. It has a force while at least
/// one of its triangles overlaps the other skin.
struct Spring {
  int side = 0;                 ///< Skin of the point, 0 or 1.
  int point = 0;                ///< Index of the point.
  int face = -1;                ///< Face of the other skin that contains the foot.
  Vec3 weights = Vec3::Zero();  ///< Barycentric weights of the foot in that face.
  Vec3 reach = Vec3::Zero();    ///< Vector from the point x to its foot y, y - x [m].
  double gap = 0.0;             ///< Signed distance of the point: -|y - x| inside, |y - x| outside [m].
  /// k times the integral of the point's hat over the overlapping area; over its whole support if nothing
  /// overlaps [N/m].
  double stiffness = 0.0;
  double force = 0.0;  ///< k times the integral of overlap times hat [N].
  /// Half of the overlap at the point times its force, summed over its triangles [J]. U is the sum over all
  /// springs, because U is homogeneous of degree 2 in the overlaps.
  double energy = 0.0;
  /// Accumulated relative displacement of the skins (SkinContact::travelled_) up to which the point is known
  /// to lie outside [m].
  double clear = 0.0;
  /// True: the foot is the nearest point in the current state. False: the foot is out of date and the point
  /// does not overlap.
  bool is_placed = false;
};

/// Resultant of all springs on the first skin.
struct Resultant {
  Vec3 force = Vec3::Zero();   ///< Total force [N].
  Vec3 moment = Vec3::Zero();  ///< Total moment about the origin [N m].
};

/// Contact of two closed skins, derived from an energy of distances. Let x be the material points of one
/// skin, y(x) the nearest point of the other skin, and d(x) the signed distance, -|x - y| inside it and
/// |x - y| outside. Let I d be the function that is linear on each triangle between the contact points and
/// equal to d at them. Then
///
///     U = 1/2 integral_A k/2 ((-I d)+)^2 dA + 1/2 integral_B k/2 ((-I d)+)^2 dA      (two-sided),
///
/// or U = integral_A k/2 ((-I d)+)^2 dA with points of the first skin alone, over the area at rest. The
/// integrals are exact (linear_gap.h): where the other surface is a plane, U is exact however coarse the
/// triangles are, at edges and corners too. Because y minimises |x - y|, the derivative of d does not involve
/// the derivative of y's weights (envelope theorem). The force is therefore the exact gradient: it acts along
/// the line through x and y, its magnitude is k times the integral of overlap times the point's hat, and the
/// opposite force is distributed to the corners of the foot's face. It is continuous, and continuously
/// differentiable where further triangles begin to overlap. A sphere of radius R pressed by delta into a
/// half-space yields k pi R delta^2 to first order in delta/R (elastic foundation of Sherman, Seth, Delp
/// 2011, per area).
///
/// Where triangles approximate a curved surface (fit_to_surface()), d is reduced by the mean height of the
/// surface above them. On triangles with edges e, against a surface of mean curvature H, I d exceeds d by
/// H sum e^2/24 in the mean; quadrature_error() estimates the resulting error.
///
/// In self-contact both skins are the same, contact points are taken from the first with half of the
/// stiffness, and the nearest point is searched only among clusters that are not neighbours of the point's
/// cluster (OwnContact).
///
/// All results are a function of the positions in the last find(), bitwise, independent of earlier queries
/// and of the number of threads. Sums are evaluated in a fixed order. Nothing is allocated after
/// construction, except when a query first runs on more threads than workers::count() was then. Two skins are
/// searched by workers::count() threads, self-contact by one.
class SkinContact {
 public:
  /// Creates the contact with points at the spacing of `spec`.
  /// @param a, b  must outlive the contact
  /// @throws Error where the stiffness or a spacing is not positive
  SkinContact(const Skin& a, const Skin& b, const SkinContactSpec& spec);
  /// Creates the contact on given meshes, each with half of the stiffness, or with all of it if the other is
  /// empty.
  /// @param stiffness  [Pa/m]  @param meshes  contact mesh per skin
  SkinContact(const Skin& a, const Skin& b, double stiffness, std::array<ContactMesh, 2> meshes);
  /// Creates self-contact of a skin, with half of the stiffness. Both node arrays of find() and follow() are
  /// then the same.
  SkinContact(const Skin& skin, double stiffness, ContactMesh mesh, OwnContact own);
  ~SkinContact();
  SkinContact(const SkinContact&) = delete;
  SkinContact& operator=(const SkinContact&) = delete;

  /// Finds the springs: all points inside, all points outside that are nearer than `near`, and all further
  /// corners of triangles that have such a point.
  /// @param nodes_a, nodes_b  positions, x y z per node [m]  @param near  search distance [m]
  void find(const double* nodes_a, const double* nodes_b, double near = 0.0);
  /// Finds the springs of self-contact.
  /// @param near  upper bound on the distance of outside points that are kept [m]
  /// @param approach  restricts them to points that may touch soon
  void find_own(const double* nodes, double near, const Approach& approach);
  /// Updates the feet of the existing springs at other positions; the result equals find() for these points.
  /// No springs are added or removed, but gaps may change their sign. A point that cannot have come inside
  /// yet, because its previous distance outside exceeds the relative displacement of the skins since then, is
  /// evaluated only where one of its triangles overlaps: see Spring::is_placed.
  void follow(const double* nodes_a, const double* nodes_b);
  /// Finds the springs by Surface::nearest alone, point by point in double precision: the reference against
  /// which tests compare find().
  void find_by_reference(const double* nodes_a, const double* nodes_b);

  /// Returns the springs of the last query, ordered by skin and point.
  const std::vector<Spring>& springs() const { return springs_; }
  /// Returns the contact points of one skin.
  const std::vector<ContactPoint>& points(int side) const {
    return meshes_[static_cast<std::size_t>(side)].points;
  }
  /// Returns whether two clusters may come into self-contact. @pre the contact is self-contact
  bool may_touch(int cluster, int other) const { return own_->neighbours.may_touch(cluster, other); }
  Vec3 position(const Spring& spring) const;  ///< Position of its point [m].
  /// Calls visit(index, position(), outward()) for all springs that are placed, on workers::count() threads;
  /// visit may be called by several threads at once.
  template <class Visit>
  void for_each_placed(Visit&& visit) {
    using V = std::remove_reference_t<Visit>;
    visit_placed(
        [](void* to, std::size_t i, const Vec3& x, const Vec3& out) { (*static_cast<V*>(to))(i, x, out); },
        &visit);
  }
  /// Returns the unit outward direction of the other skin at the spring's foot: away from the nearest point
  /// if the point is outside, towards it if inside, and the pseudonormal of Surface::outward() where the two
  /// coincide.
  Vec3 outward(const Spring& spring) const;
  /// Returns the current surface of one skin.
  const Surface& surface(int side) const { return surfaces_[side]; }
  /// Returns Surface::spread() of one skin.
  double spread(int side, const double* node_velocities, const Vec3& about) const {
    return surfaces_[side].spread(node_velocities, about);
  }
  double energy() const;                             ///< Returns U [J].
  double deepest() const;                            ///< Returns the largest penetration depth |x - y| [m].
  void add_force(double* nodes_a, double* nodes_b);  ///< Adds -dU/dq to x y z per node [N].
  /// Returns the resultant on the first skin.
  Resultant resultant() const;
  double force_sum() const;      ///< Returns the sum of the springs' force magnitudes [N].
  double largest_force() const;  ///< Returns the largest force of one spring [N].
  /// Estimates the force error caused by linear interpolation of gaps and normals: the sum over all
  /// overlapping triangles of the error magnitudes of missed_by_linear(), independent of direction [N].
  double quadrature_error() const;

 private:
  SkinContact(const Skin& a, const Skin& b, double stiffness, std::array<ContactMesh, 2> meshes,
              std::optional<OwnContact> own);
  static constexpr int kPacket = 16;  ///< Number of points that are searched together.
  struct Searcher;
  /// Points of one cluster that are updated together: range of `missing_`.
  struct PacketRange {
    std::size_t begin, end;
  };
  /// Search for one cluster: initial guess of a near face, and the springs found by a thread, range of its
  /// Searcher::found.
  struct ClusterSearch {
    int cluster, guess, worker;
    std::size_t begin, end;
  };

  void move(const double* nodes_a, const double* nodes_b, Surface::Tree tree);
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
  void follow_packet(Searcher& by, std::span<const std::size_t> springs);
  void visit_placed(void (*visit)(void* to, std::size_t i, const Vec3& x, const Vec3& out), void* to);
  void begin_search(int side, const Vec3& origin, const Eigen::AlignedBox3d& box);
  void fit_searchers();
  Searcher& searcher(int worker);
  void search_clusters(int side, double near);
  void find_side_by_reference(int side);
  struct Part {
    int cluster, tree_node;
  };
  void settle(int side, const Part& part);
  double gap_of(int side, const Eigen::AlignedBox3d& box, double near, int& near_leaf) const;
  const OwnNeighbourhood* neighbours() const { return own_ ? &own_->neighbours : nullptr; }
  bool overlaps(const ContactPoint& point, const Vec3& x, const Foot& foot) const;
  int find_cluster(Searcher& by, int side, int cluster, int start, double near, std::vector<Spring>& out);
  void add_spring(int side, int point, const Foot& foot, bool is_inside, std::vector<Spring>& out) const;
  void set_foot(Spring& spring, const Foot& foot, bool is_inside) const;
  Vec3 position(int side, const ContactPoint& point) const;
  Vec3 position(const Searcher& by, int side, int point) const;
  Vec3 outward(const Surface& other, const Spring& spring) const;
  void add_to_vertices(const Spring& spring, const Vec3& force);
  void add_to_nodes(double* nodes_a, double* nodes_b);

  std::optional<OwnContact> own_;  ///< Present for self-contact only.
  Approach approach_;
  double stiffness_;  ///< Stiffness applied to the points of one side [Pa/m].
  Surface surfaces_[2];
  std::array<ContactMesh, 2> meshes_;
  double most_lowered_[2] = {0.0, 0.0};  ///< Largest ContactTriangle::lowered per side [m].
  /// First contact point of each cluster, and the number of all points at the end.
  std::vector<int> cluster_points_[2];
  std::vector<Spring> springs_;
  /// Triangle with a spring at each corner.
  struct Triangle {
    int side = 0, number = 0;
    std::array<int, 3> spring{};
  };
  std::vector<Triangle> triangles_;  ///< Ordered by side and number.
  std::vector<Spring> added_;  ///< Springs at corners of triangles whose points were not found by the search.
  std::vector<int> spring_of_[2];  ///< Spring per point; -1: none, -2: listed in `added_`.
  std::vector<char> is_near_[2];   ///< Marks the triangles of `triangles_` while they are collected.

  // Bounds on the search. They affect its cost and do not change its result.
  /// One per thread, the first one of the calling thread.
  std::vector<std::unique_ptr<Searcher>> searchers_;
  /// Inputs of the last search on each skin, for the other threads.
  struct Query {
    Vec3 origin = Vec3::Zero();
    Eigen::AlignedBox3d box;
    long number = 0;
  };
  Query queries_[2];
  /// Inputs of the last move(), for the other threads: nodes of both skins, number of moves, and of those
  /// that fitted the trees.
  struct Positions {
    const double* nodes[2] = {nullptr, nullptr};
    long moved = 0, fitted = 0;
  };
  Positions positions_;
  std::vector<int> starts_[2];  ///< Face found near each cluster in an earlier query: initial guess.
  /// Nearest faces of each packet in the last query, padded with -1.
  std::vector<std::array<int, kPacket>> feet_[2];
  std::vector<int> first_packet_[2];  ///< First packet per cluster, and the number of all packets at the end.
  std::size_t most_packets_ = 1;      ///< Largest number of packets per cluster.
  double travelled_ = 0.0;        ///< Upper bound on the accumulated relative displacement of the skins [m].
  std::vector<double> clear_[2];  ///< Value of `travelled_` up to which each cluster is known to lie outside.
  /// Value of `travelled_` up to which each packet is known to lie outside.
  std::vector<double> packets_clear_[2];
  /// Location of a cluster. kWhole: entirely inside or entirely outside, not yet known which; kNear: close to
  /// the other skin's surface.
  enum class SideOfSurface : char { kOutside, kInside, kWhole, kNear };
  std::vector<SideOfSurface> where_[2];          ///< Location per cluster.
  std::vector<Part> whole_;                      ///< Clusters that do not come near the other skin's surface.
  std::vector<int> joined_;                      ///< Queue of connected clusters in settle().
  std::vector<std::size_t> missing_;             ///< Springs whose feet are to be updated, ascending.
  std::vector<PacketRange> packets_;             ///< Packets of `missing_`.
  std::vector<ClusterSearch> cluster_searches_;  ///< Clusters of a side that are searched, ascending.

  struct VertexForces {
    Points sum;  ///< Force per vertex; zero between calls.
    std::vector<char> is_touched;
    std::vector<int> touched;  ///< Vertices with a force, in the order of the springs.
  };
  VertexForces vertex_forces_[2];
};

}  // namespace palpate::distance
