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
/// cut into triangles, points and lines passed over, all else counted.
class Cells {
 public:
  explicit Cells(std::string path) : path_(std::move(path)) {}

  std::vector<Vec3> points;
  std::vector<long> point_numbers;  ///< of the file; empty: from 0
  std::vector<double> labels;       ///< number of the region of each tetrahedron; empty: none
  /// Ascending tetrahedra of each group, in place of labels: groups may overlap.
  std::map<double, std::vector<int>> groups;
  std::map<double, std::string> label_names;  ///< of labels or groups

  void polygon(std::vector<int> corners) { polygons_.push_back(std::move(corners)); }
  void tetrahedron(int a, int b, int c, int d) { tets_.push_back({a, b, c, d}); }
  std::size_t tetrahedra() const { return tets_.size(); }
  void unread(std::string_view what);  ///< "hexahedra", for the refusal

  /// Tetrahedra where there are any, else the triangles; points that they do not use go.  @throws Error for
  /// neither, unread cells, indices out of range
  SourceFile finish(std::string format) const;

 private:
  std::string path_;
  std::vector<std::vector<int>> polygons_;
  std::vector<std::array<int, 4>> tets_;
  std::vector<std::pair<std::string, int>> unread_;
};

std::string lower(std::string text);  ///< in small letters, of ASCII

SourceFile read_by_gmsh(const std::string& path, const std::string& format);
SourceFile read_by_cgal(const std::string& path, const std::string& format);  ///< .ply .off .stl
SourceFile read_meshb(const std::string& path);
SourceFile read_vtk(const std::string& path);
SourceFile read_vtk_xml(const std::string& path);  ///< .vtu .vtp
/// A cell of VTK's numbering of types.
void take_vtk_cell(Cells& cells, int type, const std::vector<int>& corners);

}  // namespace palpate::model
