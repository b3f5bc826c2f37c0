#include "store/vtu.h"

#include <bit>
#include <cstdint>
#include <iterator>
#include <string_view>

#include "core/markup.h"
#include "palpate/core/error.h"

namespace palpate::store {
namespace {

static_assert(std::endian::native == std::endian::little, "byte_order below says so");
constexpr const char* kFileTag = R"(<VTKFile type="{}" version="1.0" byte_order="LittleEndian")";
constexpr std::uint8_t kVtkTriangle = 5, kVtkTetra = 10;

template <class T>
constexpr const char* type_name() {
  if constexpr (std::is_same_v<T, double>) return "Float64";
  if constexpr (std::is_same_v<T, std::int32_t>) return "Int32";
  if constexpr (std::is_same_v<T, std::uint8_t>) return "UInt8";
}

/// Returns an inline array: its number of bytes, then the bytes, as one piece of base64.
template <class T>
std::string array(const char* name, int components, const T* data, std::size_t count) {
  const std::uint64_t size = count * sizeof(T);
  std::string bytes(sizeof size + size, '\0');
  std::copy_n(reinterpret_cast<const char*>(&size), sizeof size, bytes.data());
  if (size > 0) std::copy_n(reinterpret_cast<const char*>(data), size, bytes.data() + sizeof size);
  return fmt::format(
             R"(<DataArray type="{}" Name="{}" NumberOfComponents="{}" format="binary">{}</DataArray>)",
             type_name<T>(), name, components, base64(bytes)) +
         "\n";
}

/// Returns the columns of the chosen parts.
template <class Matrix>
Matrix chosen(const RunReader& run, const std::vector<int>& parts, const Matrix& all) {
  Eigen::Index count = 0;
  for (const int part : parts) count += run.parts()[static_cast<std::size_t>(part)].reference.cols();
  Matrix out(all.rows(), count);
  count = 0;
  for (const int part : parts) {
    const Eigen::Index n = run.parts()[static_cast<std::size_t>(part)].reference.cols();
    out.middleCols(count, n) = all.middleCols(run.first_point(part), n);
    count += n;
  }
  return out;
}

std::string point_array(const RunReader& run, const std::vector<int>& parts, const char* name,
                        const Points& all) {
  const Points some = chosen(run, parts, all);
  return array(name, 3, some.data(), static_cast<std::size_t>(some.size()));
}

std::string stress_array(const RunReader& run, const std::vector<int>& parts, const VecX& all) {
  const Eigen::RowVectorXd some = chosen<Eigen::RowVectorXd>(run, parts, all.transpose());
  return array("stress", 1, some.data(), static_cast<std::size_t>(some.size()));
}

/// Cells of the chosen parts, in the layout of the file.
struct PartCells {
  std::vector<std::int32_t> connectivity, offsets, part;
  std::vector<std::uint8_t> types;
  void add(const auto& columns, std::uint8_t type, Eigen::Index first_point, int number) {
    for (Eigen::Index c = 0; c < columns.cols(); ++c) {
      for (Eigen::Index r = 0; r < columns.rows(); ++r)
        connectivity.push_back(static_cast<std::int32_t>(first_point) + columns(r, c));
      offsets.push_back(static_cast<std::int32_t>(connectivity.size()));
      types.push_back(type);
      part.push_back(number);
    }
  }
};

PartCells cells_of(const RunReader& run, const std::vector<int>& parts) {
  PartCells out;
  Eigen::Index first = 0;
  for (const int number : parts) {
    const RunPart& part = run.parts()[static_cast<std::size_t>(number)];
    out.add(part.tets, kVtkTetra, first, number);
    out.add(part.faces, kVtkTriangle, first, number);
    first += part.reference.cols();
  }
  return out;
}

std::string cell_array(const char* name, const auto& values) {
  return array(name, 1, values.data(), values.size());
}

}  // namespace

std::string vtu_of(const RunReader& run, int step, const std::vector<int>& parts) {
  const Points points = chosen(run, parts, run.points(step));
  const PartCells cells = cells_of(run, parts);
  const double time = run.times_s()[static_cast<std::size_t>(step)];
  std::string out = "<?xml version=\"1.0\"?>\n";
  fmt::format_to(std::back_inserter(out), fmt::runtime(kFileTag), "UnstructuredGrid");
  out += " header_type=\"UInt64\">\n<UnstructuredGrid>\n<FieldData>\n";
  fmt::format_to(
      std::back_inserter(out),
      R"(<DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii">{}</DataArray>)", time);
  fmt::format_to(std::back_inserter(out),
                 "\n</FieldData>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n<PointData>\n",
                 points.cols(), cells.types.size());
  out += point_array(run, parts, "displacement", run.displacement(step));
  out += point_array(run, parts, "velocity", run.velocity(step));
  out += stress_array(run, parts, run.stress(step));
  out += "</PointData>\n<CellData>\n" + cell_array("body", cells.part) + "</CellData>\n<Points>\n";
  out += array("Points", 3, points.data(), static_cast<std::size_t>(points.size()));
  out += "</Points>\n<Cells>\n" + cell_array("connectivity", cells.connectivity);
  out += cell_array("offsets", cells.offsets) + cell_array("types", cells.types);
  return out + "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
}

std::string pvd_of(const std::vector<std::pair<double, std::string>>& files) {
  std::string out = "<?xml version=\"1.0\"?>\n" + fmt::format(fmt::runtime(kFileTag), "Collection");
  out += ">\n<Collection>\n";
  for (const auto& [time, name] : files)
    out += fmt::format(R"(<DataSet timestep="{}" part="0" file="{}"/>)", time, escape_markup(name)) + "\n";
  return out + "</Collection>\n</VTKFile>\n";
}

}  // namespace palpate::store
