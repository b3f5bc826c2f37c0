#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <cstring>

#include "cells.h"
#include "foreign_files.h"
#include "format_readers.h"
#include "palpate/core/error.h"
#include "store/atomic_file.h"

// Legacy VTK files (VTK User's Guide 11, "VTK file formats"; vtkDataReader for version 5):
//   # vtk DataFile Version x.x / title / ASCII | BINARY / DATASET UNSTRUCTURED_GRID | POLYDATA
//   POINTS n type, 3 n values
//   CELLS, or VERTICES, LINES, POLYGONS, TRIANGLE_STRIPS, one of
//     n size, `size` ints: corners of a cell, these, ...                            (versions up to 4)
//     n size / OFFSETS type, n values / CONNECTIVITY type, `size` values            (from 5 on; n - 1 cells)
//   CELL_TYPES n, n ints
//   CELL_DATA n, or POINT_DATA n, then
//     SCALARS name type [components] / LOOKUP_TABLE name, values;   VECTORS name type, values; ...
//   FIELD name k, k times: name components tuples type, values
//   METADATA, lines up to an empty one
// Binary values are big-endian and begin on the next line.
namespace palpate::model {
namespace {

/// Returns the bytes per value in a binary file; 0: variable size, or unknown.
std::size_t bytes_of(const std::string& type) {
  if (type == "double" || type == "long" || type == "unsigned_long" || type == "vtktypeint64" ||
      type == "vtktypeuint64")
    return 8;
  // vtkIdType is written as int.
  if (type == "float" || type == "int" || type == "unsigned_int" || type == "vtkidtype" ||
      type == "vtktypeint32" || type == "vtktypeuint32")
    return 4;
  if (type == "short" || type == "unsigned_short") return 2;
  if (type == "char" || type == "signed_char" || type == "unsigned_char") return 1;
  return 0;
}

class Legacy {
 public:
  explicit Legacy(const std::string& path) : path_(path), text_(store::read_file(path)) {
    if (!lower(text_.substr(0, 32)).starts_with("# vtk datafile"))
      fail("{}: is not a legacy VTK file: its first line must begin with \"# vtk DataFile Version\"", path_);
    line();
    line();
    const std::string form = lower(word());
    if (form != "ascii" && form != "binary")
      fail("{}: the third line must be ASCII or BINARY, found \"{}\"", path_, form.substr(0, 40));
    binary_ = form == "binary";
  }

  std::string word() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
    const std::size_t begin = at_;
    while (at_ < text_.size() && !std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
    return text_.substr(begin, at_ - begin);
  }
  /// Reads the next word in lower case; consumes it only if it is `wanted`.
  bool take(const char* requested) {
    const std::size_t before = at_;
    if (lower(word()) == requested) return true;
    at_ = before;
    return false;
  }
  std::size_t count() {
    const std::string w = word();
    std::size_t value = 0;
    if (const auto [end, code] = std::from_chars(w.data(), w.data() + w.size(), value);
        code != std::errc() || end != w.data() + w.size() || value > text_.size())
      fail("{}: found \"{}\" where a count is expected", path_, w.substr(0, 40));
    return value;
  }
  bool at_line_end() const {
    const std::size_t next = text_.find_first_not_of(" \t\r", at_);
    return next == std::string::npos || text_[next] == '\n';
  }
  void line() { at_ = std::min(text_.find('\n', at_), text_.size() - 1) + 1; }
  /// Skips to the first empty line.
  void skip_block() {
    for (line(); at_ < text_.size(); line())
      if (at_line_end()) return;
  }
  /// Reads `n` values of the type, whose name is given in lower case; strings are skipped.
  std::vector<double> values(std::size_t n, const std::string& type) {
    std::vector<double> out;
    const bool texts = type == "string" || type == "variant";  // in ASCII, one per line
    if (binary_ || texts) line();
    if (texts) {
      for (std::size_t i = 0; i < n; ++i) {
        if (at_end()) fail("{}: is truncated", path_);
        binary_ ? skip_text() : line();
      }
    } else if (type == "bit") {
      if (binary_) at_ = std::min(at_ + (n + 7) / 8, text_.size());
      for (std::size_t i = 0; i < n && !binary_; ++i) text_value();
    } else if (!binary_) {
      for (std::size_t i = 0; i < n; ++i) out.push_back(text_value());
    } else {
      const std::size_t size = bytes_of(type);
      if (size == 0) fail("{}: unknown type \"{}\"", path_, type.substr(0, 40));
      if (n > (text_.size() - at_) / size) fail("{}: is truncated", path_);
      for (std::size_t i = 0; i < n; ++i) out.push_back(binary_value(type));
    }
    return out;
  }
  /// Reads `n` values of the type whose name follows, which must be numeric.
  std::vector<double> numbers(std::size_t n) {
    const std::string type = lower(word());
    std::vector<double> out = values(n, type);
    if (out.size() != n) fail("{}: found type \"{}\" where numbers are expected", path_, type);
    return out;
  }
  bool binary() const { return binary_; }
  bool at_end() const { return at_ >= text_.size(); }

 private:
  double text_value() {
    const std::string w = word();
    const char* const begin = w.data() + w.starts_with('+');
    double value = 0;
    if (const auto [end, code] = std::from_chars(begin, w.data() + w.size(), value);
        code != std::errc() || end != w.data() + w.size())
      fail("{}: found \"{}\" where a number is expected", path_, w.substr(0, 40));
    return value;
  }
  /// Skips a string.  The two highest bits of the first byte encode the number of length bytes: 3 for 1, 2
  /// for 2, 1 for 4, 0 for 8.
  void skip_text() {
    if (at_ >= text_.size()) fail("{}: is truncated", path_);
    const auto first = static_cast<unsigned char>(text_[at_]);
    const std::size_t bytes = std::size_t{8} >> (first >> 6);
    std::uint64_t length = first & 63u;
    for (std::size_t i = 1; i < bytes && at_ + i < text_.size(); ++i)
      length = length << 8 | static_cast<unsigned char>(text_[at_ + i]);
    if (length > text_.size() - at_ || bytes > text_.size() - at_ - length) fail("{}: is truncated", path_);
    at_ += bytes + length;
  }
  template <class T>
  double big_endian() {
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), text_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    if constexpr (std::endian::native == std::endian::little) std::reverse(raw.begin(), raw.end());
    return static_cast<double>(std::bit_cast<T>(raw));
  }
  double binary_value(const std::string& type) {
    const bool is_unsigned =
        type.starts_with("unsigned") || type == "vtktypeuint64" || type == "vtktypeuint32";
    if (type == "double") return big_endian<double>();
    if (type == "float") return big_endian<float>();
    switch (bytes_of(type)) {
      case 8: return is_unsigned ? big_endian<std::uint64_t>() : big_endian<std::int64_t>();
      case 4: return is_unsigned ? big_endian<std::uint32_t>() : big_endian<std::int32_t>();
      case 2: return is_unsigned ? big_endian<std::uint16_t>() : big_endian<std::int16_t>();
      default: return is_unsigned ? big_endian<std::uint8_t>() : big_endian<std::int8_t>();
    }
  }

  std::string path_, text_;
  std::size_t at_ = 0;
  bool binary_ = false;
};

using CellList = std::vector<std::vector<int>>;

/// Reads the corners of cells, after the keyword of their kind.
CellList read_cells(Legacy& file, const std::string& path) {
  const std::size_t n = file.count(), size = file.count();
  std::vector<double> corners;
  std::vector<std::size_t> ends;  // end of each cell in `corners`
  const auto bound = [&](double value, std::size_t largest) {
    if (!(value >= 0 && value <= static_cast<double>(largest)))
      fail("{}: a cell ends at {} of {} entries", path, value, largest);
    return static_cast<std::size_t>(value);
  };
  if (file.take("offsets")) {
    const std::vector<double> offsets = file.numbers(n);
    if (!file.take("connectivity")) fail("{}: CONNECTIVITY must follow the offsets of cells", path);
    corners = file.numbers(size);
    for (std::size_t c = 1; c < offsets.size(); ++c) ends.push_back(bound(offsets[c], size));
  } else {
    const std::vector<double> entries = file.values(size, "int");
    for (std::size_t at = 0; at < entries.size() && ends.size() < n;) {
      const std::size_t count = bound(entries[at], entries.size() - at - 1);
      corners.insert(corners.end(), entries.begin() + static_cast<std::ptrdiff_t>(at) + 1,
                     entries.begin() + static_cast<std::ptrdiff_t>(at + 1 + count));
      ends.push_back(corners.size());
      at += 1 + count;
    }
    if (ends.size() != n) fail("{}: declares {} cells, but lists {}", path, n, ends.size());
  }
  CellList out;
  std::size_t begin = 0;
  for (const std::size_t end : ends) {
    if (end < begin) fail("{}: a cell ends at {} of {} entries", path, end, size);
    std::vector<int>& cell = out.emplace_back();
    for (std::size_t i = begin; i < end; ++i)
      cell.push_back(corners[i] >= 0 && corners[i] < 2e9 ? static_cast<int>(corners[i]) : -1);
    begin = end;
  }
  return out;
}

/// Returns the rank of an array's name among the known names; their number if it is unknown.
std::size_t rank_of(const std::string& name) {
  const std::vector<std::string>& known = known_region_arrays();
  return static_cast<std::size_t>(
      std::find_if(known.begin(), known.end(),
                   [&](const std::string& k) { return lower(k) == lower(name); }) -
      known.begin());
}

/// Reads the sections after the header.
class Sections {
 public:
  Sections(const std::string& path, Cells& cells) : path_(path), file_(path), cells_(cells) {}

  void read() {
    while (!file_.at_end()) {
      const std::string section = lower(file_.word());
      if (section.empty()) continue;
      if (!take_geometry(section) && !take_values(section)) {
        if (cells_.points.empty() || lists_.empty())
          fail("{}: found \"{}\" where a section is expected", path_, section.substr(0, 40));
        break;  // the mesh is complete; the content after an unknown section cannot be located
      }
    }
    add_cells();
  }

 private:
  static constexpr int kFromTypes = -1;

  bool take_geometry(const std::string& section) {
    constexpr int kVertex = 1, kLine = 4, kStrip = 6, kPolygon = 7;
    if (section == "dataset") {
      const std::string kind = lower(file_.word());
      if (kind != "unstructured_grid" && kind != "polydata")
        fail("{}: holds a {}; UNSTRUCTURED_GRID and POLYDATA are read", path_, kind.substr(0, 40));
    } else if (section == "points") {
      const std::size_t n = file_.count();
      const std::vector<double> x = file_.numbers(3 * n);
      for (std::size_t i = 0; i < n; ++i) cells_.points.emplace_back(x[3 * i], x[3 * i + 1], x[3 * i + 2]);
    } else if (section == "cells" || section == "vertices" || section == "lines" || section == "polygons" ||
               section == "triangle_strips") {
      const int type = section == "cells"      ? kFromTypes
                       : section == "vertices" ? kVertex
                       : section == "lines"    ? kLine
                       : section == "polygons" ? kPolygon
                                               : kStrip;
      lists_.emplace_back(type, read_cells(file_, path_));
    } else if (section == "cell_types") {
      types_ = file_.values(file_.count(), "int");
    } else if (section == "metadata") {
      file_.skip_block();
    } else {
      return false;
    }
    return true;
  }

  bool take_values(const std::string& section) {
    if (section == "cell_data" || section == "point_data") {
      of_cells_ = section == "cell_data";
      per_ = file_.count();
    } else if (section == "scalars") {
      const std::string name = file_.word(), type = lower(file_.word());
      const std::size_t components = file_.at_line_end() ? 1 : file_.count();
      if (file_.take("lookup_table")) file_.word();
      keep(name, components, file_.values(per_ * components, type));
    } else if (section == "field") {
      file_.word();
      for (std::size_t arrays = file_.count(); arrays > 0; --arrays) {
        while (file_.take("metadata")) file_.skip_block();
        const std::string name = file_.word();
        const std::size_t components = file_.count(), tuples = file_.count();
        const std::string type = lower(file_.word());
        keep(name, components, file_.values(components * tuples, type));
      }
    } else if (section == "lookup_table" || section == "color_scalars") {
      file_.word();
      const std::size_t n = file_.count();
      file_.values(section == "lookup_table" ? 4 * n : n * per_, file_.binary() ? "unsigned_char" : "float");
    } else if (section == "texture_coordinates") {
      file_.word();
      const std::size_t n = file_.count();
      file_.values(n * per_, lower(file_.word()));
    } else if (const std::size_t components = components_of(section); components > 0) {
      const std::string name = file_.word();
      keep(name, components, file_.values(per_ * components, lower(file_.word())));
    } else {
      return false;
    }
    return true;
  }

  static std::size_t components_of(const std::string& section) {
    if (section == "vectors" || section == "normals") return 3;
    if (section == "tensors") return 9;
    if (section == "tensors6") return 6;
    return section == "global_ids" || section == "pedigree_ids" || section == "edge_flags" ? 1 : 0;
  }

  void keep(const std::string& name, std::size_t components, std::vector<double> values) {
    if (!of_cells_ || components != 1 || rank_of(name) >= best_) return;
    best_ = rank_of(name);
    labels_ = std::move(values);
  }

  void add_cells() {
    // Cell arrays count vertices, lines, polygons and strips in this order, whatever the order of the
    // sections.
    std::stable_sort(lists_.begin(), lists_.end(), [](const auto& a, const auto& b) {
      const auto rank = [](int type) { return type == 6 ? 8 : type; };
      return rank(a.first) < rank(b.first);
    });
    std::size_t cell = 0, all = 0;
    for (const auto& [type, list] : lists_) all += list.size();
    if (!labels_.empty() && labels_.size() != all)
      fail("{}: \"{}\" has {} numbers for {} cells", path_, known_region_arrays()[best_], labels_.size(),
           all);
    for (const auto& [type, list] : lists_) {
      if (type == kFromTypes && types_.size() != list.size())
        fail("{}: has {} cells and {} types of cells", path_, list.size(), types_.size());
      for (std::size_t c = 0; c < list.size(); ++c, ++cell) {
        const std::size_t before = cells_.tetrahedra();
        take_vtk_cell(cells_, type == kFromTypes ? static_cast<int>(types_[c]) : type, list[c]);
        if (!labels_.empty() && cells_.tetrahedra() > before) cells_.labels.push_back(labels_[cell]);
      }
    }
  }

  std::string path_;
  Legacy file_;
  Cells& cells_;
  std::vector<std::pair<int, CellList>> lists_;  ///< by cell type
  std::vector<double> types_, labels_;
  std::size_t best_ = known_region_arrays().size(), per_ = 0;
  bool of_cells_ = false;
};

}  // namespace

namespace {

std::string name_of_vtk_type(int type) {
  switch (type) {
    case 11: return "voxels";
    case 12: return "hexahedra";
    case 13: return "prisms";
    case 14: return "pyramids";
    case 22: return "triangles of second order";
    case 24: return "tetrahedra of second order";
    default: return fmt::format("cells of VTK's type {}", type);
  }
}

}  // namespace

void take_vtk_cell(Cells& cells, int type, const std::vector<int>& corners) {
  constexpr int kLastLine = 4, kTriangle = 5, kStrip = 6, kPolygon = 7, kPixel = 8, kQuadrangle = 9,
                kTetrahedron = 10, kQuadraticEdge = 21;
  if (type == kTetrahedron && corners.size() == 4)
    cells.tetrahedron(corners[0], corners[1], corners[2], corners[3]);
  else if (type == kTriangle || type == kPolygon || type == kQuadrangle)
    cells.polygon(corners);
  else if (type == kPixel && corners.size() == 4)  // row by row
    cells.polygon({corners[0], corners[1], corners[3], corners[2]});
  else if (type == kStrip)  // every other triangle has the opposite orientation
    for (std::size_t i = 0; i + 2 < corners.size(); ++i)
      cells.polygon({corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]});
  else if (type > kLastLine && type != kQuadraticEdge)
    cells.unread(name_of_vtk_type(type));
}

SourceFile read_vtk(const std::string& path) {
  Cells cells(path);
  Sections(path, cells).read();
  return cells.finish("legacy VTK");
}

}  // namespace palpate::model
