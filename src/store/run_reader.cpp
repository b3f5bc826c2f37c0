#include "palpate/store/run_reader.h"

#include <algorithm>

#include "core/sandbox.h"
#include "palpate/core/error.h"
#include "store/h5.h"

namespace palpate::store {
namespace {

/// Reads a 2-d data set as a matrix whose columns are the rows of the data set.
template <class Matrix>
Matrix read_columns(hid_t parent, const char* name, H5T_class_t type_class, hid_t type,
                    const std::string& path) {
  const h5::Opened set = h5::open(parent, name, type_class, 2, path);
  if (set.shape[1] != static_cast<hsize_t>(Matrix::RowsAtCompileTime))
    fail("{}: \"{}\" has {} columns, must have {}", path, name, set.shape[1], int{Matrix::RowsAtCompileTime});
  Matrix out(Matrix::RowsAtCompileTime, static_cast<Eigen::Index>(set.shape[0]));
  if (out.size() > 0) h5::read(set, name, type, out.data(), path);
  return out;
}

h5::Id open_group(hid_t parent, const std::string& name, const std::string& path) {
  if (H5Lexists(parent, name.c_str(), H5P_DEFAULT) <= 0)
    fail("{}: has no group \"{}\"; is it a run of palpate?", path, name);
  return {h5::check(H5Gopen2(parent, name.c_str(), H5P_DEFAULT), path, "cannot open group " + name),
          H5Gclose};
}

}  // namespace

struct RunReader::Impl {
  std::string path;
  h5::Id file, root;
  RunInfo info;
  std::vector<RunPart> parts;
  std::vector<int> first;
  std::vector<double> times;
  Eigen::Index n = 0;

  void read_parts(hid_t group);
  void check_indices(const RunPart& part, const char* name, const auto& cells) const {
    if (cells.size() > 0 && (cells.minCoeff() < 0 || cells.maxCoeff() >= part.reference.cols()))
      fail("{}: \"{}\" of part \"{}\" refer to points that it does not have; the file is damaged", path, name,
           part.name);
  }
  void read_steps();
  void rows(const char* name, std::size_t rank, int step, double* out) const;
};

void RunReader::Impl::read_parts(hid_t group) {
  const h5::Id list = open_group(group, "parts", path);
  const long long count = h5::read_attribute_integer(list, "count", path);
  for (long long i = 0; i < count; ++i) {
    const h5::Id one = open_group(list, std::to_string(i), path);
    RunPart part;
    part.name = h5::read_attribute_text(one, "name", path);
    part.reference = read_columns<Points>(one, "reference", H5T_FLOAT, H5T_NATIVE_DOUBLE, path);
    part.tets = read_columns<Tets>(one, "tets", H5T_INTEGER, H5T_NATIVE_INT, path);
    part.faces = read_columns<Faces>(one, "faces", H5T_INTEGER, H5T_NATIVE_INT, path);
    check_indices(part, "tets", part.tets);
    check_indices(part, "faces", part.faces);
    if (!part.reference.allFinite())
      fail("{}: the initial positions of part \"{}\" are not finite; the file is damaged", path, part.name);
    first.push_back(static_cast<int>(n));
    n += part.reference.cols();
    parts.push_back(std::move(part));
  }
}

/// Reads the times of NSteps steps: an unfinished file has unused space behind them.
void RunReader::Impl::read_steps() {
  const h5::Id steps = open_group(root, "Steps", path);
  const long long count = h5::read_attribute_integer(steps, "NSteps", path);
  const h5::Opened values = h5::open(steps, "Values", H5T_FLOAT, 1, path);
  if (count < 0 || static_cast<hsize_t>(count) > values.shape[0])
    fail("{}: NSteps = {} but {} times; the file is damaged", path, count, values.shape[0]);
  times.resize(static_cast<std::size_t>(count));
  h5::read_rows(values, "Values", H5T_NATIVE_DOUBLE, 0, static_cast<hsize_t>(count), times.data(), path);
}

void RunReader::Impl::rows(const char* name, std::size_t rank, int step, double* out) const {
  if (step < 0 || step >= static_cast<int>(times.size()))
    fail("{}: step {} must lie in [0, {})", path, step, times.size());
  const h5::Quiet quiet;
  const h5::Opened set = h5::open(root, name, H5T_FLOAT, rank, path);
  if (rank == 2 && set.shape[1] != 3)
    fail("{}: \"{}\" has {} columns, must have 3", path, name, set.shape[1]);
  h5::read_rows(set, name, H5T_NATIVE_DOUBLE, static_cast<hsize_t>(step) * static_cast<hsize_t>(n),
                static_cast<hsize_t>(n), out, path);
}

/// Reads all steps of a short run, and the first and last of a long one.
void RunReader::read_through() const {
  constexpr double kMostNumbers = 1e7;
  const bool all = 10.0 * static_cast<double>(impl_->n) * steps() < kMostNumbers;
  for (int step = 0; step < steps(); step += all ? 1 : std::max(1, steps() - 1)) {
    points(step);
    displacement(step);
    velocity(step);
    stress(step);
  }
}

RunReader::RunReader(const std::string& path) : impl_(std::make_unique<Impl>()) {
  sandboxed_read(path, "HDF5", [&] { RunReader(path).read_through(); });
  const h5::Quiet quiet;
  Impl& d = *impl_;
  d.path = path;
  d.file = h5::open_file(path);
  d.root = open_group(d.file, "VTKHDF", path);
  const h5::Id own = open_group(d.file, "palpate", path);
  d.info.version = h5::read_attribute_text(own, "version", path);
  d.info.scene_name = h5::read_attribute_text(own, "scene_name", path);
  d.info.scene_source = h5::read_text(own, "scene", path);
  d.read_parts(own);
  d.read_steps();
  d.info.expected_steps = static_cast<int>(d.times.size());
}

RunReader::~RunReader() = default;
RunReader::RunReader(RunReader&&) noexcept = default;

int RunReader::steps() const { return static_cast<int>(impl_->times.size()); }
int RunReader::point_count() const { return static_cast<int>(impl_->n); }
const std::vector<double>& RunReader::times_s() const { return impl_->times; }
const RunInfo& RunReader::info() const { return impl_->info; }
const std::vector<RunPart>& RunReader::parts() const { return impl_->parts; }
int RunReader::first_point(int part) const { return impl_->first.at(static_cast<std::size_t>(part)); }

Points RunReader::points(int step) const {
  Points out(3, impl_->n);
  impl_->rows("Points", 2, step, out.data());
  return out;
}
Points RunReader::displacement(int step) const {
  Points out(3, impl_->n);
  impl_->rows("PointData/displacement", 2, step, out.data());
  return out;
}
Points RunReader::velocity(int step) const {
  Points out(3, impl_->n);
  impl_->rows("PointData/velocity", 2, step, out.data());
  return out;
}
VecX RunReader::stress(int step) const {
  VecX out(impl_->n);
  impl_->rows("PointData/stress", 1, step, out.data());
  return out;
}

}  // namespace palpate::store
