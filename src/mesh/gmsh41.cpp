#include "gmsh.h"

// Gmsh 4.1, ASCII (reference manual, "MSH file format"):
//   $Nodes: blocks nodes min-tag max-tag; each block: dimension entity parametric n, n lines of tags, n lines  x y z [u v w]
//   $Elements: blocks elements min-tag max-tag; each block: dimension entity type n, n lines  tag node...
namespace palpate::mesh::gmsh {
namespace {

void require_total(const TextFile& file, std::string_view what, long announced, long found) {
  if (announced != found) file.fail("{} {} stand in the blocks, but the section announces {}; one of the counts is wrong", found, what, announced);
}

}  // namespace

void nodes_41(TextFile& file, Content& content) {
  file.require_line("the counts of $Nodes");
  const int blocks = file.count("number of node blocks");
  const int announced = file.count("number of nodes");
  long found = 0;
  std::vector<long> tags;
  for (int b = 0; b < blocks; ++b) {
    file.require_line("a block of nodes");
    file.integer("entity dimension");
    file.integer("entity tag");
    file.integer("parametric flag");
    const int n = file.count("number of nodes in the block");
    tags.clear();
    for (int i = 0; i < n; ++i) {
      file.require_line("a node's number");
      tags.push_back(file.integer("node number"));
    }
    for (const long tag : tags) {
      file.require_line("a node's coordinates");
      add_node(file, content, tag);
    }
    found += n;
  }
  require_total(file, "nodes", announced, found);
}

void elements_41(TextFile& file, Content& content) {
  file.require_line("the counts of $Elements");
  const int blocks = file.count("number of element blocks");
  const int announced = file.count("number of elements");
  long found = 0;
  for (int b = 0; b < blocks; ++b) {
    file.require_line("a block of elements");
    file.integer("entity dimension");
    file.integer("entity tag");
    const long type = file.integer("element type");
    const int n = file.count("number of elements in the block");
    for (int i = 0; i < n; ++i) {
      file.require_line("an element");
      if (type == kTet4) add_tet(file, content, file.integer("element number"));
    }
    if (type == kTet10) content.second_order_tets += n;
    found += n;
  }
  require_total(file, "elements", announced, found);
}

}  // namespace palpate::mesh::gmsh
