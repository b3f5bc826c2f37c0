#pragma once
#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/model/foreign_files.h"

namespace palpate::model {

/// Gathers the cells of a foreign file: linear triangles and tetrahedra are taken, quadrangles and polygons
/// cut into fans, points and lines passed over, all else counted.
class Cells {
 public:
  explicit Cells(std::string path) : path_(std::move(path)) {}

  std::vector<Vec3> points;
  std::vector<long> point_numbers;  ///< of the file; empty: from 0
  std::vector<double> labels;       ///< number of the region of each tetrahedron; empty: none
  std::map<double, std::string> label_names;
  std::optional<double> no_label;  ///< the number of those without a region

  void triangle(int a, int b, int c) { triangles_.push_back({a, b, c}); }
  void polygon(const std::vector<int>& corners);
  void tetrahedron(int a, int b, int c, int d) { tets_.push_back({a, b, c, d}); }
  std::size_t tetrahedra() const { return tets_.size(); }
  void unread(std::string_view what);  ///< "hexahedra", for the refusal

  /// Tetrahedra where there are any, else the triangles; points that they do not use go.  @throws Error for
  /// neither, unread cells, indices out of range
  SourceFile finish(std::string format) const;

 private:
  std::string path_;
  std::vector<std::array<int, 3>> triangles_;
  std::vector<std::array<int, 4>> tets_;
  std::vector<std::pair<std::string, int>> unread_;
};

SourceFile read_by_gmsh(const std::string& path, const std::string& format);
SourceFile read_by_cgal(const std::string& path, const std::string& format);  ///< .ply .off .stl
SourceFile read_meshb(const std::string& path);
/// of a legacy VTK file: the number of each tetrahedron's region; empty: it has no array known for that
std::vector<double> labels_of_vtk(const std::string& path);
SourceFile read_vtu(const std::string& path);

}  // namespace palpate::model
