#pragma once
#include <array>
#include <map>
#include <string>
#include <vector>

#include "palpate/core/types.h"
#include "text_file.h"

namespace palpate::mesh::gmsh {

/// Volume of the model, or part of one that belongs to a partition.
struct Volume {
  long whole = 0;            ///< tag of the volume, or of the volume that contains the part
  std::vector<long> groups;  ///< physical volumes
};

/// Content of the sections of a .msh file, in the file's numbering.
struct Content {
  std::vector<Vec3> nodes;
  std::vector<long> node_tags;
  std::vector<int> node_lines;
  std::vector<std::array<long, 4>> tets;
  std::vector<long> tet_tags;
  std::vector<int> tet_lines;
  std::vector<double> tet_entity;                    ///< volume of the model, per tetrahedron
  std::map<double, std::vector<int>> tets_of_group;  ///< ascending, per physical volume
  std::map<double, std::string> volume_names;        ///< names of physical volumes
  bool repeats = false;                              ///< elements are repeated for each of their groups (2.2)
  std::map<std::array<long, 4>, int> tet_of_nodes;   ///< if repeats: by ascending corners
  std::map<long, Volume> volumes;                    ///< 4.1: by the tags used in $Elements
  long second_order_tets = 0;
};

constexpr long kTet4 = 4, kTet10 = 11;  // Gmsh's element types

/// Reads the three coordinates of node `tag`, which precedes them on the line (2.2) or is on a separate line
/// (4.1).
void add_node(TextFile& file, Content& content, long tag);
/// Reads the four nodes of tetrahedron `tag`, up to the end of the line.  A repeated tetrahedron is added to
/// the new groups only.
void add_tet(TextFile& file, Content& content, long tag, const std::vector<long>& groups, long entity);

/// Reads section $PhysicalNames, the same in both versions: dimension, number and "name" per line.
void physical_names(TextFile& file, Content& content);

/// Section readers: each starts on the line after the section's name and ends before the line `$End...`.
void nodes_22(TextFile& file, Content& content);
void elements_22(TextFile& file, Content& content);
void nodes_41(TextFile& file, Content& content);
void entities_41(TextFile& file, Content& content);
void partitioned_entities_41(TextFile& file, Content& content);  ///< after $Entities
void elements_41(TextFile& file, Content& content);

}  // namespace palpate::mesh::gmsh
