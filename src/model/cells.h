#pragma once
#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "source_file.h"

namespace palpate::model {

/// Collects the cells of a foreign file: linear triangles and tetrahedra are stored, quadrangles and polygons
/// are cut into triangles, points and lines are skipped, all other cells are counted as unread.
class Cells {
 public:
  explicit Cells(std::string path) : path_(std::move(path)) {}

  std::vector<Vec3> points;
  std::vector<long> point_numbers;  ///< numbers in the file; empty: 0, 1, ...
  std::vector<double> labels;       ///< region number per tetrahedron; empty: none
  /// Tetrahedra of each group, ascending, in place of labels: groups may overlap.
  std::map<double, std::vector<int>> groups;
  std::map<double, std::string> label_names;  ///< names of labels or groups

  /// Adds a polygon by its corners, indices into `points`.
  void polygon(std::vector<int> corners) { polygons_.push_back(std::move(corners)); }
  /// Adds a tetrahedron by its corners, indices into `points`.
  void tetrahedron(int a, int b, int c, int d) { tets_.push_back({a, b, c, d}); }
  std::size_t tetrahedra() const { return tets_.size(); }
  void unread(std::string_view what);  ///< counts an unread cell, e.g. "hexahedra", for the error message

  /// Returns the tetrahedra if there are any, else the triangles, without unused points.
  /// @throws Error for neither, unread cells, indices out of range
  SourceFile finish(std::string format) const;

 private:
  std::string path_;
  std::vector<std::vector<int>> polygons_;
  std::vector<std::array<int, 4>> tets_;
  std::vector<std::pair<std::string, int>> unread_;
};

std::string lower(std::string text);  ///< converts ASCII letters to lower case

/// Adds a cell of a VTK cell type.
void take_vtk_cell(Cells& cells, int type, const std::vector<int>& corners);

}  // namespace palpate::model
