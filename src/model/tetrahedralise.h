#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "model/limits.h"
#include "model/progress.h"
#include "palpate/mesh/mesh.h"

namespace palpate::model {

/// Points of a line [m], in order; closed if first and last point agree.
using Polyline = std::vector<Vec3>;

/// Name of the refinement stage.
inline constexpr const char* kRefining = "fill with tetrahedra";
/// Names of the optimisation stages; each can be skipped, at the cost of smaller angles.
inline constexpr const char* kMovingVertices = "move vertices for larger angles";
inline constexpr const char* kExudingSlivers = "exude slivers";
/// Optimisation stages to run, and the reasons for skipped ones.
struct Optimisation {
  bool move_vertices = true, exude_slivers = true;
  std::string why_not_moved, why_not_exuded;  ///< reasons, for the note
};

/// Options of `tetrahedralise`.
struct TetrahedraOptions {
  int tetrahedra = 10000;  ///< target number, met within 3 %
  /// Target number of nodes, met within 3 % by finer or coarser boundary faces; 0: no target, boundary faces
  /// are as large as cells.
  int nodes = 0;
  /// Target mean edge length, met within 3 %, in place of the number; 0: the number applies.
  double element_size_m = 0.0;
  /// If creases need more than the target number, more are made instead of failing.
  bool at_least = false;
  std::optional<double> crease_deg = {};  ///< edges of the surface that turn by more than this are kept sharp
  /// Further lines on the surface to keep sharp, closed if first and last point agree.
  std::vector<Polyline> creases = {};
  Limits limits = {};
  Optimisation optimisation = {};
  std::function<void(const std::string&)> stage = {};  ///< is called at the start of each stage; may be empty
  std::function<void(const Vec3&)> place = {};  ///< is called often with the place of the work; may be empty
};

/// Tetrahedra, and how they were found.
struct Tetrahedra {
  TetMesh mesh;
  double cell_size = 0.0;               ///< bound on circumradii that gave the target number [m]
  int attempts = 0;                     ///< meshes made in the search
  std::vector<std::string> notes = {};  ///< places where the surface was too sharp or thin to be followed
};

/// Fills a closed surface.  Delaunay refinement (Boissonnat and Oudot 2005; Jamin, Alliez, Yvinec and
/// Boissonnat 2015) with a uniform bound on circumradii, which is searched for the target number; then
/// vertices are moved to enlarge the smallest dihedral angles (Tournois, Srinivasan and Alliez 2009), again
/// after Lloyd's method (Du and Wang 2003) if these stay below 4 degrees, and slivers are exuded by weights
/// (Cheng et al. 2000).  One thread and fixed seeds: the same surface gives bitwise the same mesh. If the
/// surface is too sharp or too thin for that, a least element size applies, tetrahedra at places where the
/// boundary then touches itself are removed, and a note reports it: the refinement ends for every surface.
/// @param surface  closed, outwards, without self-intersections (repair.h)
/// @throws Error for a number that cannot be met, and beyond the limits
Tetrahedra tetrahedralise(const TriMesh& surface, const TetrahedraOptions& options,
                          const Progress& progress = {});

/// Fills the inside of an implicit surface, { p : f(p) < 0 }, by the same criteria.
/// @param centre, radius  a ball that contains the inside, with its centre inside [m]
/// @throws Error for a radius that is not positive, a centre outside, a number that cannot be met, and beyond
///   the limits
Tetrahedra tetrahedralise(const std::function<double(const Vec3&)>& f, const Vec3& centre, double radius,
                          const TetrahedraOptions& options, const Progress& progress = {});

}  // namespace palpate::model
