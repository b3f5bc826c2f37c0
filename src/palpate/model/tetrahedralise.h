#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "palpate/mesh/mesh.h"
#include "palpate/model/limits.h"
#include "palpate/model/progress.h"

namespace palpate::model {

using Polyline = std::vector<Vec3>;

inline constexpr const char* kRefining = "fill with tetrahedra";
/// Stages of optimisation; each can be left out, at the cost of smaller angles.
inline constexpr const char* kMovingVertices = "move vertices for larger angles";
inline constexpr const char* kExudingSlivers = "exude slivers";
struct Optimisation {
  bool move_vertices = true, exude_slivers = true;
  std::string why_not_moved, why_not_exuded;  ///< for the note
};

struct TetrahedraOptions {
  int tetrahedra = 10000;  ///< wanted number, met within 3 %
  /// and this many nodes, within 3 %, by finer or coarser boundary faces; 0: as they come, faces as large as
  /// cells
  int nodes = 0;
  /// instead of a number: the wanted mean edge length, met within 3 %; 0: the number counts
  double element_size_m = 0.0;
  /// where creases need more than the wanted number, more are taken instead of refusing
  bool at_least = false;
  std::optional<double> crease_deg = {};  ///< edges of the surface that turn by more than this are kept sharp
  /// and these lines, which lie on the surface, closed where first and last point agree
  std::vector<Polyline> creases = {};
  Limits limits = {};
  Optimisation optimisation = {};
  std::function<void(const std::string&)> stage = {};  ///< is called where a stage begins; may be empty
  std::function<void(const Vec3&)> place = {};         ///< is called with the place of the work, often
};

/// Tetrahedra, and how they were found.
struct Tetrahedra {
  TetMesh mesh;
  double cell_size = 0.0;               ///< the bound on circumradii that gave the wanted number [m]
  int attempts = 0;                     ///< meshes made to find it
  std::vector<std::string> notes = {};  ///< where the surface was too sharp or thin to be followed
};

/// Fills a closed surface: Delaunay refinement (Boissonnat and Oudot 2005; Jamin, Alliez, Yvinec and
/// Boissonnat 2015) with a uniform bound on circumradii, which is searched for the wanted number; then
/// vertices are moved for the smallest dihedral angles (Tournois, Srinivasan and Alliez 2009) and slivers
/// exuded by weights (Cheng et al. 2000).  One thread and fixed seeds: the same surface gives the same bits.
/// Where the surface is too sharp or too thin for that, smallest elements are bounded, what then touches
/// itself is taken away, and a note says so: it ends for every surface.
/// @param surface  closed, outwards, without self-intersections (repair.h)
/// @throws Error for a number that cannot be met, and beyond the limits
Tetrahedra tetrahedralise(const TriMesh& surface, const TetrahedraOptions& options,
                          const Progress& progress = {});

/// Fills the inside of an implicit surface, { p : f(p) < 0 }, by the same criteria.
/// @param centre, radius  a ball that holds the inside, its centre inside [m]
Tetrahedra tetrahedralise(const std::function<double(const Vec3&)>& f, const Vec3& centre, double radius,
                          const TetrahedraOptions& options, const Progress& progress = {});

}  // namespace palpate::model
