#pragma once
#include "corner_table.h"
#include "palpate/mesh/mesh.h"
#include "palpate/shapes/shapes.h"

namespace palpate::shapes {

/// What a remeshed surface keeps to.
struct RemeshRules {
  Implicit inside;                          ///< vertices lie on its zero set
  std::function<double(const Vec3&)> size;  ///< wanted edge length, as a factor; empty: 1
  /// rims lie in x = 0 and slide in it; else they are kept as they are
  bool rims_in_plane = false;
  double probe = 1e-5;  ///< step of differences for the slope of `inside` [m]
};

/// Makes a triangle surface even: splits long edges, collapses short ones, flips edges towards six neighbours
/// a vertex, moves vertices towards the middle of their surroundings and back onto the surface (Botsch and
/// Kobbelt 2004, "A remeshing approach to multiresolution modeling").
/// Keeps genus and rims.  The same input gives the same output to the bit.
class Remesher {
 public:
  Remesher(const TriMesh& mesh, RemeshRules rules);

  double edge_for(int vertices) const;  ///< the edge length [m] at which an even mesh has that many vertices
  void round(double edge);              ///< one round of all four steps
  /// flips edges until none is left to flip: what a plane triangulation of slivers needs first
  void delaunay();
  void settle(int rounds);               ///< flips and moves alone: the number of vertices stays
  void trim(double edge, int vertices);  ///< splits or collapses the worst edges until the number is met
  int count() const;                     ///< vertices; of the whole body where half of it is meshed
  TriMesh result() const;

 private:
  Vec3 slope(const Vec3& p, double* value) const;
  Vec3 on_surface(Vec3 p, bool in_plane, double reach) const;
  double relative(int h) const;  ///< length over wanted length, for edge = 1 m
  double size_at(const Vec3& p) const { return rules_.size ? rules_.size(p) : 1.0; }
  Vec3 area_vector(int h) const;
  Vec3 ring_vector(int v) const;
  bool real(int h) const { return !table_.gone(h) && !table_.touches_ghost(h); }
  bool is_rim(int v) const { return rim_[v] != 0; }
  /// Between two vertices of rims in the plane, but not along a rim: such edges make faces that lie in the
  /// plane, and do not stay.
  bool is_chord(int h) const {
    return rules_.rims_in_plane && is_rim(table_.from(h)) && is_rim(table_.to(h)) && !table_.on_rim(h);
  }
  bool try_split(int h);
  bool try_collapse(int h, double longest);
  void split_long(double edge);
  void collapse_short(double edge);
  void flip_by_valence();
  int flip_by_angle();
  void move();
  void place(int v, const Vec3& goal);
  void project();

  CornerTable table_;
  RemeshRules rules_;
  std::vector<Vec3> x_;
  std::vector<double> size_;
  std::vector<char> rim_;
};

}  // namespace palpate::shapes
