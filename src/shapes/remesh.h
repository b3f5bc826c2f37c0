#pragma once
#include "corner_table.h"
#include "palpate/mesh/mesh.h"
#include "shapes/shapes.h"

namespace palpate::shapes {

/// Constraints of a remeshing.
struct RemeshRules {
  Implicit inside;                          ///< vertices lie on its zero set
  std::function<double(const Vec3&)> size;  ///< target edge length as a factor; empty: 1
  /// true: rims lie in x = 0 and slide in it; false: rims are kept unchanged.
  bool rims_in_plane = false;
  double probe = 1e-5;  ///< step of the finite differences for the gradient of `inside` [m]
};

/// Isotropic remeshing of a triangle surface: splits long edges, collapses short ones, flips edges towards
/// six neighbours per vertex, moves vertices towards the middle of their neighbourhood and projects them onto
/// the surface (Botsch and Kobbelt 2004, "A remeshing approach to multiresolution modeling"). Keeps genus and
/// rims.  Bitwise deterministic.
class Remesher {
 public:
  Remesher(const TriMesh& mesh, RemeshRules rules);

  double edge_for(int vertices) const;  ///< returns the edge length [m] of a uniform mesh with that many
                                        ///< vertices
  void round(double edge);              ///< performs one round of all steps
  /// Flips edges until none is left to flip, as a plane triangulation of slivers requires first.
  void delaunay();
  void settle(int rounds);               ///< flips and moves only: the number of vertices stays
  void trim(double edge, int vertices);  ///< splits or collapses the worst edges until the number is met
  int count() const;                     ///< number of vertices; for half a body, of the whole body
  TriMesh result() const;

 private:
  /// Returns the gradient of `inside` at p, and its value.
  Vec3 slope(const Vec3& p, double* value) const;
  /// Projects p onto the surface.
  Vec3 on_surface(Vec3 p, bool in_plane, double reach) const;
  double relative(int h) const;  ///< length over target length, for edge = 1 m
  double size_at(const Vec3& p) const { return rules_.size ? rules_.size(p) : 1.0; }
  /// Returns the area vector of the face of h.
  Vec3 area_vector(int h) const;
  /// Returns the sum of the area vectors of the faces around v.
  Vec3 ring_vector(int v) const;
  bool real(int h) const { return !table_.gone(h) && !table_.touches_ghost(h); }
  bool is_rim(int v) const { return rim_[v] != 0; }
  /// Whether the edge joins two rim vertices in the plane without lying on a rim: such edges make faces in
  /// the plane, and are removed.
  bool is_chord(int h) const {
    return rules_.rims_in_plane && is_rim(table_.from(h)) && is_rim(table_.to(h)) && !table_.on_rim(h);
  }
  bool try_split(int h);
  bool try_collapse(int h, double longest);
  void split_long(double edge);
  void collapse_short(double edge);
  void flip_by_valence();
  /// Flips edges that violate the Delaunay criterion; returns their number.
  int flip_by_angle();
  void move();
  void place(int v, const Vec3& goal);
  /// Projects all movable vertices onto the surface.
  void project();

  CornerTable table_;
  RemeshRules rules_;
  std::vector<Vec3> x_;
  std::vector<double> size_;
  std::vector<char> rim_;
};

}  // namespace palpate::shapes
