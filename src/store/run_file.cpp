#include "palpate/store/run_file.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>

#include "core/counters.h"
#include "palpate/core/error.h"
#include "store/content_hash.h"
#include "store/series.h"
#include "store/xdmf.h"

// Layout of VTKHDF, UnstructuredGrid, temporal, as its reader interprets it (offsets in rows):
//   points of step s   Points[PointOffsets[s] ... + NumberOfPoints[PartOffsets[s]]]
//   cells of step s    Offsets[CellOffsets[s] + PartOffsets[s] ... + NumberOfCells + 1]
//                      Connectivity[ConnectivityIdOffsets[s] ...]
//   data of step s     PointData/NAME[PointDataOffsets/NAME[s] ...]
//                      CellData/NAME[CellDataOffsets/NAME[s] ...]
// One topology for all steps therefore means: one part, one entry in each NumberOf..., and PartOffsets,
// CellOffsets, ConnectivityIdOffsets, CellDataOffsets all zero.  Only the offsets of points and of their data
// vary with the step.
namespace palpate::store {
namespace {
constexpr std::uint8_t kVtkTriangle = 5, kVtkTetra = 10;

/// Cells of all parts as one grid.
struct GridCells {
  std::vector<std::int64_t> connectivity, offsets{0};
  std::vector<std::uint8_t> types;
  std::vector<std::int32_t> body;  ///< Index of the part of each cell.
  void add(const auto& columns, std::uint8_t type, std::int64_t first_point, int part) {
    for (Eigen::Index c = 0; c < columns.cols(); ++c) {
      for (Eigen::Index r = 0; r < columns.rows(); ++r) connectivity.push_back(first_point + columns(r, c));
      offsets.push_back(static_cast<std::int64_t>(connectivity.size()));
      types.push_back(type);
      body.push_back(part);
    }
  }
};

std::span<const double> numbers_of(const auto& matrix) {
  return {matrix.data(), static_cast<std::size_t>(matrix.size())};
}

void check_part(const RunPart& part) {
  const auto n = part.reference.cols();
  PALPATE_CHECK(part.tets.size() == 0 || (part.tets.minCoeff() >= 0 && part.tets.maxCoeff() < n),
                "part \"{}\": tetrahedra of {} points", part.name, n);
  PALPATE_CHECK(part.faces.size() == 0 || (part.faces.minCoeff() >= 0 && part.faces.maxCoeff() < n),
                "part \"{}\": faces of {} points", part.name, n);
  PALPATE_CHECK(part.reference.allFinite(), "part \"{}\": reference positions are not finite", part.name);
}
}  // namespace

struct RunFile::Impl {
  std::string path;
  h5::Id file, root, steps_group, n_steps;
  Points reference, displacement;
  hsize_t capacity = 1;
  std::int64_t steps = 0;
  ContentHash content;
  /// Series with one row per step: time, zeros, offsets; and fields with one row per point and step.
  std::vector<Series> values, zeros, offsets, fields;

  void write_cells(const std::vector<RunPart>& parts);
  void write_scene(const std::vector<RunPart>& parts, const RunInfo& info);
  void make_series();
  void resize(hsize_t new_capacity);
  void each(auto&& f) {
    for (auto* list : {&values, &zeros, &offsets, &fields})
      for (Series& one : *list) f(one);
  }
};

void RunFile::Impl::write_cells(const std::vector<RunPart>& parts) {
  GridCells cells;
  std::int64_t first = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    cells.add(parts[i].tets, kVtkTetra, first, static_cast<int>(i));
    cells.add(parts[i].faces, kVtkTriangle, first, static_cast<int>(i));
    first += parts[i].reference.cols();
  }
  const auto count = [&](const char* name, std::int64_t n) {
    h5::write(root, name, H5T_NATIVE_INT64, {1}, &n, path);
  };
  count("NumberOfPoints", first);
  count("NumberOfCells", static_cast<std::int64_t>(cells.types.size()));
  count("NumberOfConnectivityIds", static_cast<std::int64_t>(cells.connectivity.size()));
  h5::write(root, "Connectivity", H5T_NATIVE_INT64, {cells.connectivity.size()}, cells.connectivity.data(),
            path);
  h5::write(root, "Offsets", H5T_NATIVE_INT64, {cells.offsets.size()}, cells.offsets.data(), path);
  h5::write(root, "Types", H5T_NATIVE_UINT8, {cells.types.size()}, cells.types.data(), path);
  const h5::Id data = h5::create_group(root, "CellData", path);
  h5::write(data, "body", H5T_NATIVE_INT32, {cells.body.size()}, cells.body.data(), path);
}

/// Writes data outside the VTKHDF group, which VTK ignores: the scene, and the points and cells of each part.
void RunFile::Impl::write_scene(const std::vector<RunPart>& parts, const RunInfo& info) {
  const h5::Id group = h5::create_group(file, "palpate", path);
  h5::write_attribute_text(group, "version", info.version, path);
  h5::write_attribute_text(group, "scene_name", info.scene_name, path);
  h5::write_text(group, "scene", info.scene_source, path);
  const h5::Id list = h5::create_group(group, "parts", path);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const h5::Id part = h5::create_group(list, std::to_string(i), path);
    h5::write_attribute_text(part, "name", parts[i].name, path);
    const RunPart& p = parts[i];
    h5::write(part, "reference", H5T_NATIVE_DOUBLE, {static_cast<hsize_t>(p.reference.cols()), 3},
              p.reference.data(), path);
    h5::write(part, "tets", H5T_NATIVE_INT, {static_cast<hsize_t>(p.tets.cols()), 4}, p.tets.data(), path);
    h5::write(part, "faces", H5T_NATIVE_INT, {static_cast<hsize_t>(p.faces.cols()), 3}, p.faces.data(), path);
  }
  const std::int64_t n = static_cast<std::int64_t>(parts.size());
  h5::write_attribute(list, "count", H5T_NATIVE_INT64, {}, &n, path);
}

void RunFile::Impl::make_series() {
  const hsize_t n = static_cast<hsize_t>(reference.cols());
  const h5::Id point_data = h5::create_group(root, "PointData", path);
  const h5::Id point_offsets = h5::create_group(steps_group, "PointDataOffsets", path),
               cell_offsets = h5::create_group(steps_group, "CellDataOffsets", path);
  values.emplace_back(steps_group, "Values", H5T_NATIVE_DOUBLE, 1, 0, capacity, "s", path);
  values.emplace_back(steps_group, "NumberOfParts", H5T_NATIVE_INT64, 1, 0, capacity, "", path);
  for (const char* name : {"PartOffsets", "CellOffsets", "ConnectivityIdOffsets"})
    zeros.emplace_back(steps_group, name, H5T_NATIVE_INT64, 1, 0, capacity, "", path);
  zeros.emplace_back(cell_offsets, "body", H5T_NATIVE_INT64, 1, 0, capacity, "", path);
  offsets.emplace_back(steps_group, "PointOffsets", H5T_NATIVE_INT64, 1, 0, capacity, "", path);
  for (const char* name : {"displacement", "velocity", "stress"})
    offsets.emplace_back(point_offsets, name, H5T_NATIVE_INT64, 1, 0, capacity, "", path);
  fields.emplace_back(root, "Points", H5T_NATIVE_DOUBLE, n, 3, capacity, "m", path);
  fields.emplace_back(point_data, "displacement", H5T_NATIVE_DOUBLE, n, 3, capacity, "m", path);
  fields.emplace_back(point_data, "velocity", H5T_NATIVE_DOUBLE, n, 3, capacity, "m/s", path);
  fields.emplace_back(point_data, "stress", H5T_NATIVE_DOUBLE, n, 0, capacity, "Pa", path);
}

void RunFile::Impl::resize(hsize_t new_capacity) {
  if (new_capacity == capacity) return;
  each([&](Series& one) { one.resize(new_capacity); });
  h5::check(H5Fflush(file, H5F_SCOPE_LOCAL), path, "cannot be flushed");
  capacity = new_capacity;
}

RunFile::RunFile(const std::string& path, const std::vector<RunPart>& parts, const RunInfo& info)
    : impl_(std::make_unique<Impl>()) {
  counters::count("store.run_file");
  const h5::Quiet quiet;
  Impl& d = *impl_;
  Eigen::Index n = 0;
  for (const RunPart& part : parts) {
    check_part(part);
    n += part.reference.cols();
  }
  d.path = path;
  d.capacity = static_cast<hsize_t>(std::max(1, info.expected_steps));
  d.reference.resize(3, n);
  d.displacement.resize(3, n);
  n = 0;
  for (const RunPart& part : parts) {
    d.reference.middleCols(n, part.reference.cols()) = part.reference;
    n += part.reference.cols();
  }
  std::error_code ignored;
  // A sidecar of an earlier run would be taken for this one's.
  std::filesystem::remove(xdmf_path(path), ignored);
  d.file = h5::create_file(path);
  d.root = h5::create_group(d.file, "VTKHDF", path);
  const std::int64_t version[2] = {2, 0}, none = 0;
  h5::write_attribute(d.root, "Version", H5T_NATIVE_INT64, {2}, version, path);
  h5::write_attribute_text(d.root, "Type", "UnstructuredGrid", path);
  d.write_scene(parts, info);
  d.write_cells(parts);
  d.steps_group = h5::create_group(d.root, "Steps", path);
  h5::write_attribute(d.steps_group, "NSteps", H5T_NATIVE_INT64, {}, &none, path);
  d.n_steps =
      h5::Id{h5::check(H5Aopen(d.steps_group, "NSteps", H5P_DEFAULT), path, "cannot open NSteps"), H5Aclose};
  d.make_series();
  h5::check(H5Fflush(d.file, H5F_SCOPE_LOCAL), path, "cannot be flushed; is the disk full?");
}

RunFile RunFile::continued(const std::string& path, const std::vector<RunPart>& parts, const RunInfo& info,
                           const Place& place) {
  const std::string temporary = path + ".part";
  std::optional<RunFile> out;
  {
    const RunReader old(path);
    if (old.steps() < place.steps)
      fail("{}: has {} states, but had {} at the checkpoint; it was changed since, run the scene again", path,
           old.steps(), place.steps);
    const auto is_same = [](const RunPart& a, const RunPart& b) {
      return a.name == b.name && a.reference.cols() == b.reference.cols() && a.tets.cols() == b.tets.cols() &&
             a.faces.cols() == b.faces.cols();
    };
    if (!std::equal(parts.begin(), parts.end(), old.parts().begin(), old.parts().end(), is_same))
      fail("{}: its bodies are not those of the scene; run the scene again", path);
    out.emplace(temporary, parts, info);
    for (int i = 0; i < place.steps; ++i)
      out->append(old.times_s()[static_cast<std::size_t>(i)], old.points(i), old.velocity(i), old.stress(i));
  }
  if (out->place().content != place.content) {
    out.reset();
    std::filesystem::remove(temporary), std::filesystem::remove(xdmf_path(temporary));
    fail(
        "{}: its states differ from those at the checkpoint; the file was changed or damaged since, run the "
        "scene again",
        path);
  }
  std::error_code error;
  std::filesystem::rename(temporary, path, error);
  if (error) fail("{}: cannot be replaced: {}", path, error.message());
  out->impl_->path = path;
  std::filesystem::remove(xdmf_path(path), error);
  return std::move(*out);
}

void RunFile::append(double time_s, const Points& points, const Points& velocity, const VecX& stress) {
  Impl& d = *impl_;
  const Eigen::Index n = d.reference.cols();
  PALPATE_CHECK(d.file >= 0, "{} is closed", d.path);
  PALPATE_CHECK(points.cols() == n && velocity.cols() == n && stress.size() == n,
                "{} points, {} velocities, {} stresses; the run has {}", points.cols(), velocity.cols(),
                stress.size(), n);
  PALPATE_CHECK(points.allFinite() && velocity.allFinite() && stress.allFinite(),
                "t = {}: a state that is not finite must not be recorded", time_s);
  const h5::Quiet quiet;
  const hsize_t step = static_cast<hsize_t>(d.steps);
  if (step >= d.capacity) d.resize(2 * d.capacity);

  d.displacement = points - d.reference;
  const std::int64_t zero = 0, one_part = 1, offset = d.steps * n;
  d.values[0].write(step, &time_s);
  d.values[1].write(step, &one_part);
  for (Series& one : d.zeros) one.write(step, &zero);
  for (Series& one : d.offsets) one.write(step, &offset);
  d.fields[0].write(step, points.data());
  d.fields[1].write(step, d.displacement.data());
  d.fields[2].write(step, velocity.data());
  d.fields[3].write(step, stress.data());
  h5::check(H5Fflush(d.file, H5F_SCOPE_LOCAL), d.path, "cannot be flushed; is the disk full?");

  // Commits the step: readers ignore it until this number is in the file.
  const std::int64_t done = d.steps + 1;
  h5::check(H5Awrite(d.n_steps, H5T_NATIVE_INT64, &done), d.path, "cannot write NSteps");
  h5::check(H5Fflush(d.file, H5F_SCOPE_LOCAL), d.path, "cannot be flushed; is the disk full?");
  d.steps = done;
  d.content.add_numbers({&time_s, 1})
      .add_numbers(numbers_of(points))
      .add_numbers(numbers_of(velocity))
      .add_numbers(numbers_of(stress));
}

RunFile::Place RunFile::place() const { return {steps(), impl_->content.hex()}; }
int RunFile::steps() const { return static_cast<int>(impl_->steps); }
int RunFile::point_count() const { return static_cast<int>(impl_->reference.cols()); }

void RunFile::close() {
  Impl& d = *impl_;
  if (d.file < 0) return;
  const h5::Quiet quiet;
  d.resize(static_cast<hsize_t>(d.steps));
  d.values.clear(), d.zeros.clear(), d.offsets.clear(), d.fields.clear();
  d.n_steps = {}, d.steps_group = {}, d.root = {};
  d.file = {};
  write_xdmf(d.path);
}

RunFile::RunFile(RunFile&&) noexcept = default;
RunFile::~RunFile() {
  if (!impl_) return;
  try {
    close();
  } catch (const std::exception&) {  // Committed steps are in the file; a destructor cannot report errors.
  }
}

}  // namespace palpate::store
