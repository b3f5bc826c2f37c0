#include "gmsh.h"

// Gmsh 2.x, ASCII (reference manual, "MSH file format version 2"):
//   $Nodes: number-of-nodes, then per line  tag x y z  ($ParametricNodes: more entries follow on the line)
//   $Elements: number-of-elements, then per line  tag type number-of-tags tag... node...;
//              the first two tags are the physical group (0: none) and the entity of the model; an element in
//              several groups is repeated once for each
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
  content.repeats = true;
  file.require_line("the number of elements");
  const int n = file.count("number of elements");
  for (int i = 0; i < n; ++i) {
    file.require_line("an element");
    const long tag = file.integer("element number");
    const long type = file.integer("element type");
    if (type == kTet10) ++content.second_order_tets;
    if (type != kTet4) continue;
    const long labels = file.integer("number of tags");
    long first[2] = {0, 0};
    for (long k = 0; k < labels; ++k) {  // ends at the end of the line, however large the number
      const long label = file.integer("tag");
      if (k < 2) first[k] = label;
    }
    add_tet(file, content, tag, {first[0]}, first[1]);
  }
}

}  // namespace palpate::mesh::gmsh
