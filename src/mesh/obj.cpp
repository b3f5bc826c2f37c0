#include <algorithm>
#include <charconv>
#include <limits>
#include <vector>

#include "mesh/readers.h"
#include "text_file.h"

// Wavefront OBJ:
//   v x y z [w | r g b]
//   f v v v ...          each v one of  7  7/1  7//3  7/1/3, counted from 1, or from the end if negative
// Texture coordinates, normals, groups and materials are ignored.  A backslash at a line's end continues it.
namespace palpate::mesh {
namespace {

/// Returns the vertex of one corner, counted from zero.  A vertex of a later line is allowed, so the upper
/// bound is checked at the end.
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

struct ObjFace {
  std::vector<int> corners;
  int line;
};

ObjFace read_face(TextFile& file, std::size_t vertices, std::size_t number) {
  file.about("face", static_cast<long>(number));
  ObjFace out{{}, file.line()};
  for (auto word = file.word(); !word.empty(); word = file.word())
    out.corners.push_back(corner(file, word, vertices));
  if (out.corners.size() < 3) file.fail("it has {} corners, a face has at least 3", out.corners.size());
  return out;
}

/// Cuts the polygons into triangles, which keep their polygon's number and line.
void cut_faces(const std::vector<ObjFace>& faces, const std::vector<Vec3>& vertices, SurfaceFile& out) {
  std::vector<std::array<int, 3>> triangles;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const auto& corners = faces[f].corners;
    if (const int largest = *std::max_element(corners.begin(), corners.end());
        largest >= static_cast<int>(vertices.size()))
      fail("{}:{}: face {}: vertex {} is not in the file; it has {} vertices", out.from.source, faces[f].line,
           f + 1, static_cast<long>(largest) + 1, vertices.size());
    append_polygon(vertices, corners, triangles, out.polygons);
    out.from.element_number.resize(triangles.size(), static_cast<long>(f) + 1);
    out.from.element_line.resize(triangles.size(), faces[f].line);
  }
  out.mesh.faces.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t t = 0; t < triangles.size(); ++t)
    out.mesh.faces.col(static_cast<Eigen::Index>(t)) = Eigen::Map<const Eigen::Vector3i>(triangles[t].data());
}

}  // namespace

SurfaceFile read_obj(const std::string& path) {
  TextFile file(path, {.comment = '#', .continued = true});
  SurfaceFile out;
  out.from = surface_provenance(path);
  std::vector<Vec3> vertices;
  std::vector<ObjFace> faces;
  while (file.next_line()) {
    const std::string_view keyword = file.word();
    if (keyword == "v") {
      file.about("vertex", static_cast<long>(vertices.size()) + 1);
      const double x = file.real("x"), y = file.real("y"), z = file.real("z");
      vertices.emplace_back(x, y, z);
      out.from.node_number.push_back(static_cast<long>(vertices.size()));
      out.from.node_line.push_back(file.line());
    } else if (keyword == "f") {
      faces.push_back(read_face(file, vertices.size(), faces.size() + 1));
    }
  }
  out.mesh.vertices.resize(3, static_cast<Eigen::Index>(vertices.size()));
  for (std::size_t i = 0; i < vertices.size(); ++i)
    out.mesh.vertices.col(static_cast<Eigen::Index>(i)) = vertices[i];
  cut_faces(faces, vertices, out);
  return out;
}

}  // namespace palpate::mesh
