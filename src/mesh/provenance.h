#pragma once
#include <string>
#include <vector>

namespace palpate::mesh {

/// Origin of the entries of a mesh, so that a message can refer to `liver.msh:812: element 305`.  The lists
/// are as long as the mesh, or empty (a generator, a binary file): then entries are numbered from zero.
struct Provenance {
  std::string source;       ///< file name, or `generator "ball"`
  std::string node_source;  ///< file of the nodes, if separate (TetGen)
  std::string node_noun = "node", element_noun = "element";
  std::vector<long> node_number, element_number;  ///< numbers in the file
  std::vector<int> node_line, element_line;

  std::string node(int i) const;       ///< `FILE:LINE: node 12`
  std::string element(int e) const;    ///< `FILE:LINE: element 305`
  std::string node_name(int i) const;  ///< `node 12`, for the middle of a message
};
Provenance surface_provenance(std::string source);  ///< uses the nouns "vertex" and "face"

}  // namespace palpate::mesh
