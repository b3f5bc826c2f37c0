#pragma once
#include <vector>

#include "proxy/body_motion.h"
#include "proxy/proxy_set.h"
#include "proxy/table.h"

/// Data shared by proxy_set_build.cpp (once), proxy_set.cpp (every update), proxy_set_motion.cpp (motion)
/// and proxy_set_patches.cpp (patch queries).  The bounds are derived in proxy_set.cpp.
namespace palpate::proxy {

/// Set of nodes whose motion is fitted or bounded.
struct Cloud {
  int first = 0, count = 0, lanes = 0;  // range in the node tables
  Vec3 middle = Vec3::Zero();           // mean of the rest positions
  Mat3 spread = Mat3::Zero();           // M
};

struct ProxySet::Impl {
  ProxySetOptions options;
  bool soft = false;
  Eigen::Index node_count = 0;
  int count = 0, largest_cloud = 0;
  std::vector<int> bone;
  std::vector<ProxyState> states;
  std::vector<Vec3> rest_centre, centre;
  std::vector<double> outside, weight_sum;  // e and s per proxy
  std::vector<Cloud> own, guide;            // nodes that bound each proxy; nodes that move it
  std::vector<int> first_corner, corner_count;
  Table rest_corners, corners;
  std::vector<int> node;           // per slot of the node tables
  Table rest_nodes, coefficients;  // relative to the cloud's middle; q
  Table gathered;                  // positions of one cloud
  std::vector<double> squares;     // |d|^2 per slot
  std::vector<char> adjacent;      // count x count
  SkinPatches skin;
  std::vector<int> patch_slots;  // slots of each patch's nodes
  Table rest_balls, balls;       // centres of the patches, proxy by proxy in whole lanes
  std::vector<double> rest_radius, radius;
  std::vector<int> first_ball;  // per proxy
  std::vector<int> ball_of_patch;
  std::vector<long> balls_at, measured_at;  // last update per proxy; per patch
  std::vector<unsigned char> near;          // scratch of patches_near
  Table near_balls;
  std::vector<double> near_radius;
  std::vector<int> near_patch;
  std::vector<ProxyBranch> tree;

  // Motion (proxy_set_motion.cpp): the nodes' velocities, or the rigid field linear X + offset.
  Points velocities;
  Mat3 rate = Mat3::Zero();
  Vec3 rate_offset = Vec3::Zero();
  double rate_norm = 0.0;          // spectral norm of `rate`
  std::vector<double> rest_reach;  // per rigid proxy: radius of its skin about rest_centre
  ProxyMotion whole, widest;
  std::vector<ProxyMotion> motions;
  std::vector<long> motion_at;  // per proxy
  long motions_set = 0;
  std::vector<double> thickness;  // per proxy, at rest
  /// Sets all motions to zero.
  void rest();
  void set_rigid_motion(const Mat3& linear, const Vec3& offset, double norm);
  /// Computes the motion bound of a proxy.
  void measure_motion(int proxy);
  void add_motions();

  long moment = 0;              // counts updates
  std::vector<long> fitted_at;  // per proxy
  BodyMotion motion;
  std::vector<Box> boxes, kept_boxes;  // per proxy: loose at present; tight when `motion` was kept
  double kept_size = 0.0;              // sum of their half edges; 0: never kept

  struct Nodes;
  Nodes divide_nodes(const LayeredModel& model);
  void add_proxy(const LayeredModel& model, int proxy, Nodes& all);
  void find_adjacent(const LayeredModel& model);
  /// Adds a set of nodes to the node tables.
  Cloud add_cloud(const TetMesh& tets, const std::vector<int>& nodes);
  void add_patch_nodes(const LayeredModel& model);
  void add_balls();
  Vec3 first_node(const Cloud& cloud) const;
  void fit(const Cloud& cloud, ProxyState& state);
  void gather(const Cloud& cloud, const Vec3& origin);
  /// Fits a proxy to the present nodes.
  void refit(int proxy);
  double loosen();
  /// Returns the placement of a proxy, computed on first use after an update.
  ProxyState& ready(int proxy) {
    const auto at = static_cast<std::size_t>(proxy);
    if (fitted_at[at] != moment) refit(proxy);
    return states[at];
  }
  /// Moves the balls of a proxy's patches, once per update.
  void ready_balls(int proxy);
  /// Tightens the ball of a patch, once per update.
  void measure(int patch);
  void place(int proxy, double residual, double reach);
};

}  // namespace palpate::proxy
