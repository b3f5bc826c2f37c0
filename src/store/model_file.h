#pragma once
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "mesh/layered_model.h"

/// Model file (.h5): a layered model, its figures, and its provenance.  `nodes` and `tets` have the same
/// place as in the native mesh file, so read_mesh() reads a model file too.
///
///   nodes n x 3 [m], tets m x 4: the tetrahedra
///   skin/       vertices, faces: the visible and touchable surface
///   embedding/  tet, weights (4 per vertex): the skin's vertices in the tetrahedra
///   proxies/    corners, corner_offsets, members, member_offsets, bone
///               hull p: corners[corner_offsets[p] ... corner_offsets[p + 1])
///   skeleton/   names (one per line), parent, head, tail, head_radius, tail_radius, bone_of_node
///   regions/    names (one per line), tets, offsets, youngs_modulus_factor, density_factor
///               region r: tets[offsets[r] ... offsets[r + 1]), ascending; regions may overlap
///   refined/    edges k x 2: the last k nodes are midpoints of edges between earlier nodes, in order
///   made/       source, source_hash, options, version, notes (one per line),
///               figure_names (one per line), figures
/// A missing group is an empty part of the model.
namespace palpate::store {

/// Provenance of a model.  It contains neither time nor machine: the same input gives the same file, byte for
/// byte.
struct ModelRecord {
  std::string source;              ///< File name without its folder, or the name of a shape.
  std::string source_hash;         ///< ContentHash of the source file.
  std::string options;             ///< Options as on a command line; empty for none.
  std::string version;             ///< Version of palpate.
  std::vector<std::string> notes;  ///< Faults found and repaired, one sentence each.
  std::vector<std::pair<std::string, double>> figures;  ///< Counts and quality figures; names carry units.
};

/// Content of a model file.
struct ModelFile {
  LayeredModel model;
  ModelRecord record;
  /// For divided tetrahedra (mesh/refine.h): ends of the edge whose midpoint each of the last nodes is.
  std::vector<std::array<int, 2>> edges = {};
};

/// Writes a model file atomically: a reader never sees an incomplete file.  @throws Error when it cannot be
/// written
void write_model(const std::string& path, const ModelFile& file);

/// Reads a model file.
/// @throws Error with the file, the data set and the expectation, also where the parts are inconsistent: an
///   embedding of another skin, a proxy with an unknown vertex, a skin vertex in no proxy, a bone before its
///   parent
ModelFile read_model(const std::string& path);

/// Reads only the regions of a model file; returns none where the file is a plain mesh file.
/// @param path  file
/// @param tets  number of tetrahedra in the file
/// @throws Error as read_model
std::vector<MaterialRegion> read_regions(const std::string& path, int tets);

/// Reads only the edges of divided tetrahedra; returns none where the file has none.
/// @param path  file
/// @param nodes  number of nodes in the file
/// @throws Error as read_model
std::vector<std::array<int, 2>> read_edges(const std::string& path, int nodes);

/// Whether the file's format attribute is that of a model (read_mesh() also reads its tetrahedra).
bool is_model(const std::string& path);

}  // namespace palpate::store
