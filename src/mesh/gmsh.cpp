#include "gmsh.h"

#include <algorithm>
#include <cstdlib>
#include <unordered_map>

#include "mesh/readers.h"

namespace palpate::mesh {
namespace gmsh {

void add_node(TextFile& file, Content& content, long tag) {
  file.about("node", tag);
  const double x = file.real("x"), y = file.real("y"), z = file.real("z");
  content.nodes.emplace_back(x, y, z);
  content.node_tags.push_back(tag);
  content.node_lines.push_back(file.line());
}

void add_tet(TextFile& file, Content& content, long tag, const std::vector<long>& groups, long entity) {
  file.about("element", tag);
  std::array<long, 4> nodes{};
  for (long& node : nodes) node = file.integer("node number");
  file.require_end_of_line();
  std::array<long, 4> corners = nodes;
  std::sort(corners.begin(), corners.end());
  const auto join = [&](int tet) {
    bool joined = false;
    for (const long group : groups) {
      if (group == 0) continue;
      // The tag is negative if the volume is flipped.
      std::vector<int>& members = content.tets_of_group[static_cast<double>(std::abs(group))];
      const auto at = std::lower_bound(members.begin(), members.end(), tet);
      if (at != members.end() && *at == tet) continue;
      members.insert(at, tet);
      joined = true;
    }
    return joined;
  };
  const auto tet = static_cast<int>(content.tets.size());
  if (content.repeats) {
    const auto [known, is_new] = content.tet_of_nodes.emplace(corners, tet);
    if (!is_new && join(known->second)) return;
  }
  content.tets.push_back(nodes);
  content.tet_tags.push_back(tag);
  content.tet_lines.push_back(file.line());
  content.tet_entity.push_back(static_cast<double>(entity));
  join(tet);
}

void physical_names(TextFile& file, Content& content) {
  file.require_line("the number of physical names");
  const int n = file.count("number of physical names");
  for (int i = 0; i < n; ++i) {
    file.require_line("a physical name");
    const long dimension = file.integer("dimension"), tag = file.integer("physical tag");
    const std::string_view quoted = file.rest();
    if (quoted.size() < 2 || quoted.front() != '"' || quoted.back() != '"')
      file.fail("a name in double quotes is expected, found {}", printable(quoted));
    if (dimension == 3)
      content.volume_names[static_cast<double>(tag)] = std::string(quoted.substr(1, quoted.size() - 2));
  }
}

namespace {

constexpr std::string_view kConvert = "convert it: gmsh {0} -save -format msh41 -o NEW.msh";

/// Reads `$MeshFormat` up to its end; returns 2 or 4 (for 4.1).
int major_version(TextFile& file) {
  const std::string convert = fmt::format(fmt::runtime(kConvert), file.path());
  file.require_line("$MeshFormat");
  std::string_view section = file.word();
  while (section == "$Comments") {
    while (section != "$EndComments") file.require_line("$EndComments"), section = file.word();
    file.require_line("$MeshFormat");
    section = file.word();
  }
  if (section == "$NOD") file.fail("this is Gmsh format 1 ($NOD), which palpate does not read; {}", convert);
  if (section != "$MeshFormat")
    file.fail("a Gmsh mesh starts with $MeshFormat, found \"{}\"; check that this is a .msh file of Gmsh",
              printable(section));
  file.require_line("the format's version");
  const double version = file.real("version");
  const long is_binary = file.integer("file type");
  if (is_binary != 0)
    file.fail("this mesh is binary (file type {}), palpate reads ASCII; {}", is_binary, convert);
  const bool is_2 = version >= 2.0 && version < 2.25, is_41 = version == 4.1;
  if (!is_2 && !is_41) file.fail("Gmsh format {} is not read, only 2.2 and 4.1; {}", version, convert);
  file.require_line("$EndMeshFormat");
  if (const auto end = file.word(); end != "$EndMeshFormat")
    file.fail("$EndMeshFormat is expected, found \"{}\"", printable(end));
  return is_2 ? 2 : 4;
}

void skip_section(TextFile& file, const std::string& end) {
  do file.require_line(end);
  while (file.word() != end);
}

Content read(TextFile& file) {
  Content content;
  const bool is_2 = major_version(file) == 2;
  while (file.next_line()) {
    const std::string_view name = file.word();
    if (!name.starts_with('$'))
      file.fail("a section ($...) is expected, found \"{}\"; a count before it may be too small",
                printable(name));
    const std::string end = fmt::format("$End{}", name.substr(1));
    const bool entities = name == "$Entities" && !is_2, parts = name == "$PartitionedEntities" && !is_2;
    if (name == "$PhysicalNames" || entities || parts) {
      entities ? entities_41(file, content)
      : parts  ? partitioned_entities_41(file, content)
               : physical_names(file, content);
      skip_section(file, end);
      continue;
    }
    const bool nodes = name == "$Nodes" || name == "$ParametricNodes", elements = name == "$Elements";
    if (!nodes && !elements) {
      skip_section(file, end);
      continue;
    }
    if (nodes) is_2 ? nodes_22(file, content) : nodes_41(file, content);
    if (elements) is_2 ? elements_22(file, content) : elements_41(file, content);
    file.require_line(end);
    if (const auto word = file.word(); word != end)
      file.fail("{} is expected, found \"{}\"; the count of its entries is wrong", end, printable(word));
  }
  return content;
}

/// Returns the physical volumes; if there are none, the volumes of the model.
std::vector<MaterialRegion> regions(Content& content) {
  if (content.tets_of_group.empty()) return regions_of_labels(content.tet_entity);
  return regions_of_groups(std::move(content.tets_of_group), content.volume_names, content.tets.size());
}

/// Returns the index in the list of nodes by tag; tags may be sparse and in any order.
std::unordered_map<long, int> index_of_tags(const std::string& path, const Content& content) {
  std::unordered_map<long, int> out;
  for (std::size_t i = 0; i < content.nodes.size(); ++i)
    if (const auto [it, is_new] = out.emplace(content.node_tags[i], static_cast<int>(i)); !is_new)
      fail("{}:{}: node {} is defined here and in line {}; node numbers must differ", path,
           content.node_lines[i], content.node_tags[i],
           content.node_lines[static_cast<std::size_t>(it->second)]);
  return out;
}

}  // namespace
}  // namespace gmsh

TetFile read_gmsh(const std::string& path) {
  TextFile file(path);
  gmsh::Content content = gmsh::read(file);
  if (content.tets.empty() && content.second_order_tets > 0)
    fail(
        "{}: its {} tetrahedra are of second order (type 11), palpate takes linear ones; mesh with "
        "Mesh.ElementOrder = 1",
        path, content.second_order_tets);

  const auto indices = gmsh::index_of_tags(path, content);
  TetFile out;
  out.mesh.nodes.resize(3, static_cast<Eigen::Index>(content.nodes.size()));
  for (std::size_t i = 0; i < content.nodes.size(); ++i)
    out.mesh.nodes.col(static_cast<Eigen::Index>(i)) = content.nodes[i];
  out.mesh.tets.resize(4, static_cast<Eigen::Index>(content.tets.size()));
  for (std::size_t t = 0; t < content.tets.size(); ++t)
    for (int k = 0; k < 4; ++k) {
      const long tag = content.tets[t][static_cast<std::size_t>(k)];
      const auto found = indices.find(tag);
      if (found == indices.end())
        fail("{}:{}: element {}: node {} is not in the file; it has {} nodes", path, content.tet_lines[t],
             content.tet_tags[t], tag, content.nodes.size());
      out.mesh.tets(k, static_cast<Eigen::Index>(t)) = found->second;
    }
  out.from = {.source = path,
              .node_source = "",
              .node_number = std::move(content.node_tags),
              .element_number = std::move(content.tet_tags),
              .node_line = std::move(content.node_lines),
              .element_line = std::move(content.tet_lines)};
  out.regions = gmsh::regions(content);
  return out;
}

}  // namespace palpate::mesh
