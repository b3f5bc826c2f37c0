#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <cstring>

#include "cells.h"
#include "palpate/core/error.h"
#include "palpate/store/atomic_file.h"

// libgmsh 4.8 writes the numbers of cells into legacy VTK files and does not read them.  Here they are (VTK
// User's Guide 11, "VTK file formats", versions up to 4):
//   # vtk DataFile Version x.x / title / ASCII | BINARY / DATASET UNSTRUCTURED_GRID
//   POINTS n type, 3 n values          CELLS n size, `size` ints          CELL_TYPES n, n ints
//   CELL_DATA n:  SCALARS name type [components] / LOOKUP_TABLE name, n values;   FIELD name k, k times: name
//   components tuples type, values;   others
//   POINT_DATA n: the same
// binary values are big-endian and begin on the line after.
namespace palpate::model {
namespace {

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

class Legacy {
 public:
  explicit Legacy(std::string path) : path_(std::move(path)), text_(store::read_file(path_)) {
    line();
    line();
    binary_ = lower(word()) == "binary";
  }

  std::string word() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
    const std::size_t begin = at_;
    while (at_ < text_.size() && !std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
    return text_.substr(begin, at_ - begin);
  }
  std::size_t count() {
    const std::string w = word();
    std::size_t value = 0;
    if (const auto [end, code] = std::from_chars(w.data(), w.data() + w.size(), value);
        code != std::errc() || end != w.data() + w.size() || value > text_.size())
      fail("{}: \"{}\" stands where a count is expected", path_, w.substr(0, 40));
    return value;
  }
  bool at_line_end() const {
    const std::size_t next = text_.find_first_not_of(" \t\r", at_);
    return next == std::string::npos || text_[next] == '\n';
  }
  void line() { at_ = std::min(text_.find('\n', at_), text_.size() - 1) + 1; }
  std::vector<double> values(std::size_t n, const std::string& type) {
    std::vector<double> out;
    if (binary_) line();
    for (std::size_t i = 0; i < n; ++i) out.push_back(binary_ ? binary_value(type) : text_value());
    return out;
  }
  bool at_end() const { return at_ >= text_.size(); }
  const std::string& path() const { return path_; }

 private:
  double text_value() {
    const std::string w = word();
    double value = 0;
    if (const auto [end, code] = std::from_chars(w.data(), w.data() + w.size(), value);
        code != std::errc() || end != w.data() + w.size())
      fail("{}: \"{}\" stands where a number is expected", path_, w.substr(0, 40));
    return value;
  }
  template <class T>
  double big_endian() {
    std::array<char, sizeof(T)> raw;
    if (at_ + sizeof(T) > text_.size()) fail("{}: ends before its time", path_);
    std::memcpy(raw.data(), text_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    if constexpr (std::endian::native == std::endian::little) std::reverse(raw.begin(), raw.end());
    return static_cast<double>(std::bit_cast<T>(raw));
  }
  double binary_value(const std::string& type) {
    if (type == "double") return big_endian<double>();
    if (type == "float") return big_endian<float>();
    if (type == "int" || type == "vtkidtype") return big_endian<std::int32_t>();
    if (type == "unsigned_int") return big_endian<std::uint32_t>();
    if (type == "long") return big_endian<std::int64_t>();
    if (type == "short") return big_endian<std::int16_t>();
    if (type == "unsigned_char") return big_endian<std::uint8_t>();
    if (type == "char") return big_endian<std::int8_t>();
    fail("{}: unknown type \"{}\"", path_, type);
  }

  std::string path_, text_;
  std::size_t at_ = 0;
  bool binary_ = false;
};

/// Rank of an array's name among those that are known; their number where it is not.
std::size_t rank_of(const std::string& name) {
  const std::vector<std::string>& known = known_region_arrays();
  return static_cast<std::size_t>(
      std::find_if(known.begin(), known.end(),
                   [&](const std::string& k) { return lower(k) == lower(name); }) -
      known.begin());
}

}  // namespace

std::vector<double> labels_of_vtk(const std::string& path) {
  constexpr double kTetrahedron = 10;
  Legacy file(path);
  std::vector<double> types, labels;
  std::size_t best = known_region_arrays().size(), per = 0;
  bool of_cells = false;
  const auto keep = [&](const std::string& name, std::size_t components, const std::vector<double>& values) {
    if (!of_cells || components != 1 || rank_of(name) >= best) return;
    best = rank_of(name);
    labels = values;
  };
  while (!file.at_end()) {
    const std::string section = lower(file.word());
    if (section == "points") {
      const std::size_t n = file.count();
      file.values(3 * n, lower(file.word()));
    } else if (section == "cells") {
      file.count();
      file.values(file.count(), "int");
    } else if (section == "cell_types") {
      types = file.values(file.count(), "int");
    } else if (section == "cell_data" || section == "point_data") {
      of_cells = section == "cell_data";
      per = file.count();
    } else if (section == "scalars") {
      const std::string name = file.word(), type = lower(file.word());
      const std::size_t components = file.at_line_end() ? 1 : file.count();
      file.word();  // LOOKUP_TABLE
      file.word();
      keep(name, components, file.values(per * components, type));
    } else if (section == "field") {
      file.word();
      for (std::size_t arrays = file.count(); arrays > 0; --arrays) {
        const std::string name = file.word();
        const std::size_t components = file.count(), tuples = file.count();
        const std::string type = lower(file.word());
        keep(name, components, file.values(components * tuples, type));
      }
    } else if (section == "vectors" || section == "normals" || section == "tensors") {
      file.word();
      const std::string type = lower(file.word());
      file.values(per * (section == "tensors" ? 9 : 3), type);
    } else if (section != "dataset" && section != "unstructured_grid" && !section.empty()) {
      break;  // after something else nothing can be found for sure
    }
  }
  if (labels.empty()) return {};
  if (labels.size() != types.size())
    fail("{}: \"{}\" has {} numbers for {} cells", path, known_region_arrays()[best], labels.size(),
         types.size());
  std::vector<double> out;
  for (std::size_t c = 0; c < types.size(); ++c)
    if (types[c] == kTetrahedron) out.push_back(labels[c]);
  return out;
}

}  // namespace palpate::model
