#include "store/series.h"

#include <algorithm>

namespace palpate::store {
namespace {
constexpr hsize_t kSmallChunkBytes = 16u << 10, kLargeChunkBytes = 4u << 20;

/// Returns the rows of a chunk: one step, or several where steps are tiny, or a fraction where they are huge.
hsize_t chunk_rows(hsize_t rows, hsize_t row_bytes, hsize_t capacity) {
  const hsize_t step_bytes = std::max<hsize_t>(1, rows * row_bytes);
  if (step_bytes > kLargeChunkBytes) return std::max<hsize_t>(1, kLargeChunkBytes / row_bytes);
  const hsize_t steps = std::clamp<hsize_t>(kSmallChunkBytes / step_bytes, 1, std::max<hsize_t>(1, capacity));
  return std::max<hsize_t>(1, rows * steps);
}

std::vector<hsize_t> shape(hsize_t rows, hsize_t width) {
  return width == 0 ? std::vector<hsize_t>{rows} : std::vector<hsize_t>{rows, width};
}
}  // namespace

Series::Series(hid_t parent, const std::string& name, hid_t type, hsize_t rows, hsize_t width,
               hsize_t capacity, const std::string& units, const std::string& path)
    : type_(type), rows_(rows), width_(width), name_(name), path_(path) {
  const auto size = shape(rows * capacity, width), most = shape(H5S_UNLIMITED, width);
  const auto chunk =
      shape(chunk_rows(rows, H5Tget_size(type) * std::max<hsize_t>(1, width), capacity), width);
  const h5::Id space{H5Screate_simple(static_cast<int>(size.size()), size.data(), most.data()), H5Sclose};
  const h5::Id creation{H5Pcreate(H5P_DATASET_CREATE), H5Pclose};
  H5Pset_chunk(creation, static_cast<int>(chunk.size()), chunk.data());
  H5Pset_alloc_time(creation, H5D_ALLOC_TIME_EARLY);  // Allocates the space and the chunk index now,
  H5Pset_fill_time(creation, H5D_FILL_TIME_NEVER);    // but writes no byte of it: the file is sparse.
  H5Pset_obj_track_times(creation, false);
  set_ = h5::Id{h5::check(H5Dcreate2(parent, name.c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT),
                          path, "cannot create " + name),
                H5Dclose};
  if (!units.empty()) h5::write_attribute_text(set_, "units", units, path);
}

void Series::write(hsize_t step, const void* data) {
  if (rows_ == 0) return;
  const auto start = shape(step * rows_, 0), size = shape(rows_, width_);
  const std::vector<hsize_t> from = width_ == 0 ? start : std::vector<hsize_t>{start[0], 0};
  const h5::Id in_file{H5Dget_space(set_), H5Sclose};
  const h5::Id in_memory{H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr), H5Sclose};
  h5::check(H5Sselect_hyperslab(in_file, H5S_SELECT_SET, from.data(), nullptr, size.data(), nullptr), path_,
            "cannot select a step of " + name_);
  h5::check(H5Dwrite(set_, type_, in_memory, in_file, H5P_DEFAULT, data), path_,
            "cannot write " + name_ + "; is the disk full?");
}

void Series::resize(hsize_t capacity) {
  const auto size = shape(rows_ * capacity, width_);
  h5::check(H5Dset_extent(set_, size.data()), path_, "cannot resize " + name_);
}

}  // namespace palpate::store
