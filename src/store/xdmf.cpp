#include "store/xdmf.h"

#include <filesystem>
#include <iterator>

#include "core/markup.h"
#include "palpate/core/error.h"
#include "store/atomic_file.h"

namespace palpate::store {
namespace {

/// Field at the points, as stored in the run file.
struct PointField {
  const char* name;
  const char* kind;  ///< XDMF's AttributeType
  int width;
};
constexpr PointField kPointFields[] = {
    {"displacement", "Vector", 3}, {"velocity", "Vector", 3}, {"stress", "Scalar", 1}};

/// Writes the XML of a run line by line.
class Sidecar {
 public:
  Sidecar(const RunReader& run, const std::string& run_file) : run_(run), file_(escape_markup(run_file)) {
    rows_ = static_cast<long>(run.steps()) * run.point_count();
    for (const RunPart& part : run.parts()) cells_ += cells_of(part);
  }

  std::string text() {
    line(R"(<?xml version="1.0" encoding="UTF-8"?>)");
    line(R"(<Xdmf Version="3.0">)");
    line("<Domain>");
    line(R"(<Grid Name="{}" GridType="Collection" CollectionType="Temporal">)",
         escape_markup(run_.info().scene_name));
    for (int step = 0; step < run_.steps(); ++step) add_step(step);
    line("</Grid>");
    line("</Domain>");
    line("</Xdmf>");
    return out_;
  }

 private:
  static long cells_of(const RunPart& part) { return part.tets.cols() + part.faces.cols(); }

  template <class... Args>
  void line(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(out_), format, std::forward<Args>(args)...);
    out_ += '\n';
  }

  void add_step(int step) {
    line(R"(<Grid Name="step {}" GridType="Collection" CollectionType="Spatial">)", step);
    line(R"(<Time Value="{}"/>)", run_.times_s()[static_cast<std::size_t>(step)]);
    long first_cell = 0;
    for (std::size_t i = 0; i < run_.parts().size(); ++i) {
      const RunPart& part = run_.parts()[i];
      // A part is either a body of tetrahedra or a surface of triangles.
      if (part.tets.cols() > 0)
        add_grid(i, step, "Tetrahedron", "tets", 4, part.tets.cols(), first_cell);
      else if (part.faces.cols() > 0)
        add_grid(i, step, "Triangle", "faces", 3, part.faces.cols(), first_cell);
      first_cell += cells_of(part);
    }
    line("</Grid>");
  }

  void add_grid(std::size_t index, int step, const char* topology, const char* data, int corners, long cells,
                long first_cell) {
    const RunPart& part = run_.parts()[index];
    const long points = part.reference.cols(), first = static_cast<long>(step) * run_.point_count() +
                                                       run_.first_point(static_cast<int>(index));
    line(R"(<Grid Name="{}" GridType="Uniform">)", escape_markup(part.name));
    line(R"(<Topology TopologyType="{}" NumberOfElements="{}">)", topology, cells);
    line(R"(<DataItem Dimensions="{} {}" NumberType="Int" Precision="4" Format="HDF">{}:/palpate/parts/{}/{})"
         "</DataItem>",
         cells, corners, file_, index, data);
    line("</Topology>");
    line(R"(<Geometry GeometryType="XYZ">)");
    add_slab("/VTKHDF/Points", "Float", 8, first, points, 3, rows_);
    line("</Geometry>");
    for (const PointField& field : kPointFields) {
      line(R"(<Attribute Name="{}" AttributeType="{}" Center="Node">)", field.name, field.kind);
      add_slab(fmt::format("/VTKHDF/PointData/{}", field.name), "Float", 8, first, points, field.width,
               rows_);
      line("</Attribute>");
    }
    line(R"(<Attribute Name="body" AttributeType="Scalar" Center="Cell">)");
    add_slab("/VTKHDF/CellData/body", "Int", 4, first_cell, cells, 1, cells_);
    line("</Attribute>");
    line("</Grid>");
  }

  /// Adds rows [first, first + count) of a data set with `rows` rows; a single column means one dimension.
  ///
  /// The selection is written twice.  Readers of XDMF 2 use a hyperslab's two children; in those of XDMF 3
  /// that does not work, and they use the text before them: FILE:DATA SET|start:stride:count:shape.  The
  /// attribute is "Type" instead of "ItemType" because both then accept it: XDMF 2 reads either name, XDMF 3
  /// only the second. ParaView's reader of XDMF 2 reuses the grid of the previous step where this text is the
  /// same, so it must differ.
  void add_slab(const std::string& data_set, const char* type, int precision, long first, long count,
                int width, long rows) {
    const bool flat = width == 1;
    const auto shape = [flat](long n, int columns) {
      return flat ? fmt::format("{}", n) : fmt::format("{} {}", n, columns);
    };
    const std::string start = shape(first, 0), stride = shape(1, 1), size = shape(count, width),
                      all = shape(rows, width);
    line(R"(<DataItem Type="HyperSlab" Dimensions="{}" NumberType="{}" Precision="{}" Format="HDF">{}:{}|{})",
         size, type, precision, file_, data_set, fmt::format("{}:{}:{}:{}", start, stride, size, all));
    line(R"(<DataItem Dimensions="3 {}" Format="XML">{} {} {}</DataItem>)", flat ? 1 : 2, start, stride,
         size);
    line(R"(<DataItem Dimensions="{}" NumberType="{}" Precision="{}" Format="HDF">{}:{}</DataItem>)", all,
         type, precision, file_, data_set);
    line("</DataItem>");
  }

  const RunReader& run_;
  std::string file_, out_;
  long rows_ = 0, cells_ = 0;
};

}  // namespace

std::string xdmf_path(const std::string& run_path) {
  return std::filesystem::path(run_path).replace_extension(".xdmf").string();
}

std::string xdmf_of(const RunReader& run, const std::string& run_file) {
  return Sidecar(run, run_file).text();
}

void write_xdmf(const std::string& run_path) {
  const RunReader run(run_path);
  if (run.steps() == 0) return;
  write_atomically(xdmf_path(run_path), xdmf_of(run, std::filesystem::path(run_path).filename().string()));
}

}  // namespace palpate::store
