#include <charconv>
#include <limits>
#include <vector>

#include "palpate/mesh/readers.h"
#include "text_file.h"

// Wavefront OBJ:
//   v x y z [w | r g b]
//   f v v v ...          each v one of  7  7/1  7//3  7/1/3, counted from 1, or from the end if negative
// Texture coordinates, normals, groups and materials are ignored.
namespace palpate::mesh {
namespace {

/// The vertex of one corner, counted from zero; a vertex of a later line is allowed, so the upper bound is
/// checked at the end.
int corner(TextFile& file, std::string_view word, std::size_t vertices) {
  const std::string_view digits = word.substr(0, word.find('/'));
  long value = 0;
  const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (code != std::errc() || end != digits.data() + digits.size())
    file.fail("corner \"{}\" has no vertex number", printable(word));
  if (value == 0) file.fail("corner \"{}\": vertices are counted from 1", printable(word));
  const long index = value > 0 ? value - 1 : static_cast<long>(vertices) + value;
  if (index < 0 || index > std::numeric_limits<int>::max())
    file.fail("corner \"{}\" is out of range; {} vertices precede this line", printable(word), vertices);
  return static_cast<int>(index);
}

void read_face(TextFile& file, std::size_t vertices, std::vector<Eigen::Vector3i>& faces, Provenance& from,
               long number) {
  file.about("face", number);
  std::vector<int> polygon;
  for (auto word = file.word(); !word.empty(); word = file.word())
    polygon.push_back(corner(file, word, vertices));
  if (polygon.size() < 3) file.fail("it has {} corners, a face has at least 3", polygon.size());
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    faces.emplace_back(polygon[0], polygon[i], polygon[i + 1]);
    from.element_number.push_back(number);
    from.element_line.push_back(file.line());
  }
}

}  // namespace

SurfaceFile read_obj(const std::string& path) {
  TextFile file(path, '#');
  SurfaceFile out;
  out.from = surface_provenance(path);
  std::vector<Vec3> vertices;
  std::vector<Eigen::Vector3i> faces;
  long polygons = 0;
  while (file.next_line()) {
    const std::string_view keyword = file.word();
    if (keyword == "v") {
      file.about("vertex", static_cast<long>(vertices.size()) + 1);
      const double x = file.real("x"), y = file.real("y"), z = file.real("z");
      vertices.emplace_back(x, y, z);
      out.from.node_number.push_back(static_cast<long>(vertices.size()));
      out.from.node_line.push_back(file.line());
    } else if (keyword == "f") {
      read_face(file, vertices.size(), faces, out.from, ++polygons);
    }
  }
  out.mesh.vertices.resize(3, static_cast<Eigen::Index>(vertices.size()));
  for (std::size_t i = 0; i < vertices.size(); ++i)
    out.mesh.vertices.col(static_cast<Eigen::Index>(i)) = vertices[i];
  out.mesh.faces.resize(3, static_cast<Eigen::Index>(faces.size()));
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (const int largest = faces[f].maxCoeff(); largest >= static_cast<int>(vertices.size()))
      fail("{}: vertex {} is not in the file; it has {} vertices", out.from.element(static_cast<int>(f)),
           static_cast<long>(largest) + 1, vertices.size());
    out.mesh.faces.col(static_cast<Eigen::Index>(f)) = faces[f];
  }
  return out;
}

}  // namespace palpate::mesh
