#include "gmsh.h"

// Gmsh 2.x, ASCII (reference manual, "MSH file format version 2"):
//   $Nodes: number-of-nodes, then  tag x y z  a line ($ParametricNodes: more entries follow on the line)
//   $Elements: number-of-elements, then  tag type number-of-tags tag... node...  a line
namespace palpate::mesh::gmsh {

void nodes_22(TextFile& file, Content& content) {
  file.require_line("the number of nodes");
  const int n = file.count("number of nodes");
  for (int i = 0; i < n; ++i) {
    file.require_line("a node");
    add_node(file, content, file.integer("node number"));
  }
}

void elements_22(TextFile& file, Content& content) {
  file.require_line("the number of elements");
  const int n = file.count("number of elements");
  for (int i = 0; i < n; ++i) {
    file.require_line("an element");
    const long tag = file.integer("element number");
    const long type = file.integer("element type");
    if (type == kTet10) ++content.second_order_tets;
    if (type != kTet4) continue;
    const long labels = file.integer("number of tags");
    for (long k = 0; k < labels; ++k) file.integer("tag");  // ends at the end of the line, however large the number
    add_tet(file, content, tag);
  }
}

}  // namespace palpate::mesh::gmsh
