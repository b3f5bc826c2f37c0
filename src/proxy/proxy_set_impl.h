#pragma once
#include <vector>

#include "palpate/proxy/proxy_set.h"
#include "proxy/lanes.h"
#include "proxy/skin_patches.h"

/// What proxy_set_build.cpp (once) and proxy_set.cpp (every update) work on; the derivation stands in proxy_set.cpp.
namespace palpate::proxy {

/// Points coordinate by coordinate, set after set, each filled up to whole lanes with its first.
struct Table {
  std::vector<double> x, y, z;

  void append(const Points& points) {
    for (int i = 0; i < padded(static_cast<int>(points.cols())); ++i) {
      const Vec3 p = points.col(i < points.cols() ? i : 0);
      x.push_back(p.x()), y.push_back(p.y()), z.push_back(p.z());
    }
  }
  void append_padded_with_zero(const Points& points) {
    for (int i = 0; i < padded(static_cast<int>(points.cols())); ++i) {
      const Vec3 p = i < points.cols() ? Vec3(points.col(i)) : Vec3(Vec3::Zero());
      x.push_back(p.x()), y.push_back(p.y()), z.push_back(p.z());
    }
  }
  Columns read(int first) const { return {x.data() + first, y.data() + first, z.data() + first}; }
  MutableColumns write(int first) { return {x.data() + first, y.data() + first, z.data() + first}; }
  int size() const { return static_cast<int>(x.size()); }
};

/// Nodes whose motion is fitted or bounded.
struct Cloud {
  int first = 0, count = 0, lanes = 0;  // in the tables of nodes
  Vec3 middle = Vec3::Zero();           // of the rest positions
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
  std::vector<double> outside, weight_sum;   // e and s of each proxy
  std::vector<Cloud> own, guide;             // what bounds it; what moves it
  std::vector<int> first_corner, corner_count;
  Table rest_corners, corners;
  std::vector<int> node;                     // of each slot of the node tables
  Table rest_nodes, coefficients;            // from the cloud's middle; q
  Table gathered;                            // positions of one cloud
  std::vector<double> squares;               // |d|^2 of every slot
  std::vector<char> adjacent;                // count x count
  SkinPatches skin;
  std::vector<int> patch_slots;              // slots of each patch's nodes
  std::vector<ProxyBranch> tree;

  Cloud add_cloud(const TetMesh& tets, const std::vector<int>& nodes);
  void add_patch_nodes(const LayeredModel& model);
  void fit(const Eigen::Ref<const Points>& nodes, const Cloud& cloud, ProxyState& state);
  void gather(const Eigen::Ref<const Points>& nodes, const Cloud& cloud, const Vec3& origin);
  void place(int proxy, double residual, double reach);
};

}  // namespace palpate::proxy
