#pragma once
#include <string>
#include <utility>
#include <vector>

#include "palpate/mesh/layered_model.h"

/// The model file (.h5): a layered model, its figures, and how it was made.  `nodes` and `tets` stand where
/// the native mesh file has them, so that read_mesh() reads a model file too.
///
///   nodes n x 3 [m], tets m x 4: the tetrahedra
///   skin/       vertices, faces: the surface that is seen and touched
///   embedding/  tet, weights (4 a vertex): the skin's vertices in the tetrahedra
///   proxies/    corners, corner_offsets, members, member_offsets, bone
///               hull p: corners[corner_offsets[p] ... corner_offsets[p + 1])
///   skeleton/   names (one a line), parent, head, tail, head_radius, tail_radius, bone_of_node
///   regions/    names (one a line), tets, offsets, youngs_modulus_factor, density_factor
///               region r: tets[offsets[r] ... offsets[r + 1]), ascending; regions may overlap
///   made/       source, source_hash, options, version, notes (one a line),
///               figure_names (one a line), figures
/// A missing group is an empty part of the model.
namespace palpate::store {

/// How a model was made.  It holds no time and no machine: the same input gives the same file, byte for byte.
struct ModelRecord {
  std::string source;              ///< file name without its folder, or the name of a shape
  std::string source_hash;         ///< ContentHash of the file
  std::string options;             ///< as they would stand on a command line; empty: none given
  std::string version;             ///< of palpate
  std::vector<std::string> notes;  ///< what was found and mended, a sentence each
  std::vector<std::pair<std::string, double>> figures;  ///< counts and quality, units in the names
};

struct ModelFile {
  LayeredModel model;
  ModelRecord record;
};

/// Whole or not at all: a reader never sees half of it.  @throws Error when it cannot be written
void write_model(const std::string& path, const ModelFile& file);

/// @throws Error with the file, the data set, and what was expected, also where the parts do not fit each
///   other: an embedding of another skin, a proxy that names a vertex that is not there, a skin vertex in no
///   proxy, a bone before its parent.
ModelFile read_model(const std::string& path);

/// The regions of a model file alone; none where the file is a plain mesh file.
/// @param tets  how many tetrahedra it has
/// @throws Error as read_model
std::vector<MaterialRegion> read_regions(const std::string& path, int tets);

/// True where the file says that it is a model (its tetrahedra alone are read by read_mesh()).
bool is_model(const std::string& path);

}  // namespace palpate::store
