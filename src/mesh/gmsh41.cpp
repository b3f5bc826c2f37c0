#include "gmsh.h"

// Gmsh 4.1, ASCII (reference manual, "MSH file format"):
//   $Entities: points curves surfaces volumes, then one line each, in this order;
//              a volume: tag, 6 numbers of its box, number of physical tags, the tags, ...
//   $PartitionedEntities: partitions; ghosts, then one line each; counts as in $Entities, then one line each;
//              a volume: tag, dimension and tag of its parent, number of partitions, these, then as above.
//              $Elements then refers to these parts
//   $Nodes:    blocks nodes min-tag max-tag;
//              each block: dimension entity parametric n, n lines of tags, n lines  x y z [u v w]
//   $Elements: blocks elements min-tag max-tag;
//              each block: dimension entity type n, n lines  tag node...
namespace palpate::mesh::gmsh {
namespace {

void require_total(const TextFile& file, std::string_view what, long announced, long found) {
  if (announced != found)
    file.fail("{} {} are in the blocks, but the section announces {}; one of the counts is wrong", found,
              what, announced);
}

/// Reads the counts of the four dimensions, skips the lines below volumes, and returns the number of volumes.
int skip_to_volumes(TextFile& file) {
  file.require_line("the counts of the entities");
  long before = 0;
  for (const char* what : {"number of points", "number of curves", "number of surfaces"})
    before += file.count(what);
  const int volumes = file.count("number of volumes");
  for (long i = 0; i < before; ++i) file.require_line("a point, curve or surface");
  return volumes;
}

/// Skips the box, and returns the physical tags after it.
std::vector<long> groups_after_box(TextFile& file) {
  for (int k = 0; k < 6; ++k) file.real("bound of its box");
  std::vector<long> out;
  for (int left = file.count("number of physical tags"); left > 0; --left)
    out.push_back(file.integer("physical tag"));
  return out;
}

}  // namespace

void entities_41(TextFile& file, Content& content) {
  for (int left = skip_to_volumes(file); left > 0; --left) {
    file.require_line("a volume");
    const long tag = file.integer("volume tag");
    content.volumes[tag] = {tag, groups_after_box(file)};
  }
}

void partitioned_entities_41(TextFile& file, Content& content) {
  file.require_line("the number of partitions");
  file.count("number of partitions");
  file.require_line("the number of ghosts");
  for (int left = file.count("number of ghosts"); left > 0; --left) file.require_line("a ghost");
  std::map<long, Volume> parts;
  for (int left = skip_to_volumes(file); left > 0; --left) {
    file.require_line("a part of a volume");
    const long tag = file.integer("tag"), dimension = file.integer("dimension of the parent"),
               parent = file.integer("tag of the parent");
    for (int partitions = file.count("number of partitions"); partitions > 0; --partitions)
      file.integer("partition");
    Volume part{dimension == 3 ? parent : tag, groups_after_box(file)};
    if (const auto whole = content.volumes.find(parent);
        part.groups.empty() && dimension == 3 && whole != content.volumes.end())
      part.groups = whole->second.groups;
    parts[tag] = std::move(part);
  }
  content.volumes = std::move(parts);
}

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
    const long entity = file.integer("entity tag");
    const auto known = content.volumes.find(entity);
    const Volume volume = known != content.volumes.end() ? known->second : Volume{entity, {}};
    const long type = file.integer("element type");
    const int n = file.count("number of elements in the block");
    for (int i = 0; i < n; ++i) {
      file.require_line("an element");
      if (type == kTet4) add_tet(file, content, file.integer("element number"), volume.groups, volume.whole);
    }
    if (type == kTet10) content.second_order_tets += n;
    found += n;
  }
  require_total(file, "elements", announced, found);
}

}  // namespace palpate::mesh::gmsh
