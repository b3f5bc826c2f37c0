#include <filesystem>

#include "mesh/readers.h"
#include "text_file.h"

// TetGen (Si 2015, manual section 5.2), `#` starts a comment, numbering starts at 0 or 1:
//   .node: points dimension attributes markers(0|1), then per line  index x y z [attribute...] [marker]
//   .ele:  tetrahedra nodes-per-tetrahedron attributes(0|1), then per line  index node... [attribute]
namespace palpate::mesh {
namespace {

/// Requires consecutive numbers, as TetGen writes them: element lines refer to them.
void require_next(const TextFile& file, std::string_view what, long number, long expected) {
  if (number != expected)
    file.fail("{} {} found where {} is expected; numbers must be consecutive", what, number, expected);
}

void read_nodes(TextFile& file, TetFile& out, long& first) {
  file.require_line("the header of the nodes");
  const int n = file.count("number of points");
  const long dimension = file.integer("dimension");
  if (dimension != 3) file.fail("dimension = {} must be 3", dimension);
  out.mesh.nodes.resize(3, n);
  for (int i = 0; i < n; ++i) {
    file.require_line("a point");
    const long number = file.integer("point number");
    if (i == 0 && number != 0 && number != 1)
      file.fail("the first point has number {}, TetGen counts from 0 or 1", number);
    if (i == 0) first = number;
    require_next(file, "point", number, first + i);
    file.about("node", number);
    const double x = file.real("x"), y = file.real("y"), z = file.real("z");
    out.mesh.nodes.col(i) = Vec3(x, y, z);
    out.from.node_number.push_back(number);
    out.from.node_line.push_back(file.line());
  }
  if (file.next_line())
    file.fail("more lines follow the {} points that the header announces; one of them is wrong", n);
}

void read_elements(TextFile& file, TetFile& out, long first) {
  file.require_line("the header of the tetrahedra");
  const int n = file.count("number of tetrahedra");
  const long corners = file.integer("nodes per tetrahedron");
  if (corners != 4)
    file.fail("{} nodes per tetrahedron; palpate takes linear ones, with 4 (run tetgen without -o2)",
              corners);
  const long points = static_cast<long>(out.mesh.nodes.cols());
  const long attributes = file.at_end_of_line() ? 0 : file.integer("number of attributes");
  std::vector<double> labels;
  out.mesh.tets.resize(4, n);
  for (int t = 0; t < n; ++t) {
    file.require_line("a tetrahedron");
    const long number = file.integer("tetrahedron number");
    require_next(file, "tetrahedron", number, first + t);
    file.about("element", number);
    for (int k = 0; k < 4; ++k) {
      const long node = file.integer("node number");
      if (node < first || node >= first + points)
        file.fail("node {} is outside {} to {}, the points of the .node file", node, first,
                  first + points - 1);
      out.mesh.tets(k, t) = static_cast<int>(node - first);
    }
    if (attributes > 0) labels.push_back(file.real("attribute"));
    out.from.element_number.push_back(number);
    out.from.element_line.push_back(file.line());
  }
  if (file.next_line())
    file.fail("more lines follow the {} tetrahedra that the header announces; one of them is wrong", n);
  out.regions = regions_of_labels(labels);
}

}  // namespace

TetFile read_tetgen(const std::string& path) {
  const std::filesystem::path stem = std::filesystem::path(path).replace_extension();
  TextFile node_file(stem.string() + ".node", {.comment = '#'}),
      element_file(stem.string() + ".ele", {.comment = '#'});
  TetFile out;
  out.from.source = element_file.path();
  out.from.node_source = node_file.path();
  long first = 0;
  read_nodes(node_file, out, first);
  read_elements(element_file, out, first);
  return out;
}

}  // namespace palpate::mesh
