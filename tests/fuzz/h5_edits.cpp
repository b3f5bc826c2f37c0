#include "fuzz/h5_edits.h"

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <vector>

#include "fuzz/input.h"
#include "store/h5.h"

namespace palpate::fuzz {
namespace fs = std::filesystem;
using store::h5::Id;

namespace {

struct Edit {
  std::uint8_t object, what, row, column;
  char number[8];
};
static_assert(sizeof(Edit) == 12);

template <class T>
T number_of(const Edit& edit) {
  T out;
  std::memcpy(&out, edit.number, sizeof out);
  return out;
}

/// Names of all groups and data sets, in HDF5's order.
std::vector<std::string> objects_of(hid_t file) {
  std::vector<std::string> out;
  H5Lvisit(
      file, H5_INDEX_NAME, H5_ITER_INC,
      [](hid_t, const char* name, const H5L_info_t*, void* list) -> herr_t {
        static_cast<std::vector<std::string>*>(list)->emplace_back(name);
        return 0;
      },
      &out);
  return out;
}

std::vector<hsize_t> shape_of(hid_t set) {
  const Id space{H5Dget_space(set), H5Sclose};
  std::vector<hsize_t> shape(static_cast<std::size_t>(std::max(0, H5Sget_simple_extent_ndims(space))));
  if (!shape.empty()) H5Sget_simple_extent_dims(space, shape.data(), nullptr);
  return shape;
}

void change_number(hid_t set, const Edit& edit) {
  std::vector<hsize_t> at = shape_of(set);
  const Id type{H5Dget_type(set), H5Tclose};
  if (at.empty() || H5Tget_class(type) == H5T_STRING) return;
  for (std::size_t i = 0; i < at.size(); ++i) {
    if (at[i] == 0) return;
    at[i] = (i == 0 ? edit.row : edit.column) % at[i];
  }
  const Id in_file{H5Dget_space(set), H5Sclose}, one{H5Screate(H5S_SCALAR), H5Sclose};
  const std::vector<hsize_t> single(at.size(), 1);
  H5Sselect_hyperslab(in_file, H5S_SELECT_SET, at.data(), nullptr, single.data(), nullptr);
  const double real = number_of<double>(edit);
  const std::int64_t whole = number_of<std::int64_t>(edit);
  const bool is_real = H5Tget_class(type) == H5T_FLOAT;
  H5Dwrite(set, is_real ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT64, one, in_file, H5P_DEFAULT,
           is_real ? static_cast<const void*>(&real) : &whole);
}

/// Replaces an object by one with another type or shape under the same name, filled with zeros.
void replace(hid_t file, const std::string& name, const Edit& edit) {
  H5Ldelete(file, name.c_str(), H5P_DEFAULT);
  Id string{H5Tcopy(H5T_C_S1), H5Tclose};
  H5Tset_size(string, edit.row % 3 == 0 ? H5T_VARIABLE : 1 + edit.column);
  const hid_t types[] = {H5T_NATIVE_DOUBLE, H5T_NATIVE_INT,   H5T_NATIVE_INT64,
                         H5T_NATIVE_FLOAT,  H5T_NATIVE_UINT8, string};
  const hsize_t shape[3] = {edit.row, edit.column, static_cast<std::uint8_t>(edit.number[2])};
  const Id space{H5Screate_simple(static_cast<std::uint8_t>(edit.number[1]) % 4, shape, nullptr), H5Sclose};
  const Id set{H5Dcreate2(file, name.c_str(), types[static_cast<std::uint8_t>(edit.number[0]) % 6], space,
                          H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
               H5Dclose};
}

/// Changes the first attribute of an object: removed, or another number.
void change_attribute(hid_t file, const std::string& name, const Edit& edit) {
  const Id object{H5Oopen(file, name.c_str(), H5P_DEFAULT), H5Oclose};
  if (H5Aget_num_attrs(object) <= 0) return;
  const Id attribute{H5Aopen_by_idx(object, ".", H5_INDEX_NAME, H5_ITER_INC, 0, H5P_DEFAULT, H5P_DEFAULT),
                     H5Aclose};
  char its_name[64] = {};
  H5Aget_name(attribute, sizeof its_name, its_name);
  const Id type{H5Aget_type(attribute), H5Tclose};
  const Id space{H5Aget_space(attribute), H5Sclose};
  const std::int64_t whole[2] = {number_of<std::int64_t>(edit), 0};
  if (edit.row % 2 == 0 || H5Tget_class(type) != H5T_INTEGER || H5Sget_simple_extent_npoints(space) > 2)
    H5Adelete(object, its_name);
  else
    H5Awrite(attribute, H5T_NATIVE_INT64, whole);
}

void apply(hid_t file, const Edit& edit) {
  const std::vector<std::string> objects = objects_of(file);
  if (objects.empty()) return;
  const std::string& name = objects[edit.object % objects.size()];
  if (edit.what % 8 == 6) return change_attribute(file, name, edit);
  if (edit.what % 8 == 7) {
    H5Ldelete(file, name.c_str(), H5P_DEFAULT);
    return;
  }
  if (edit.what % 8 == 5) return replace(file, name, edit);
  const Id set{H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose};
  if (set >= 0) change_number(set, edit);
}

}  // namespace

std::string edited(const char* name, void (*write_seed)(const std::string&), std::string_view bytes) {
  const store::h5::Quiet quiet;
  const fs::path seed = InputFile::folder() / (std::string("seed-") + name),
                 out = InputFile::folder() / (std::string("edited-") + name);
  if (!fs::exists(seed)) write_seed(seed.string());
  fs::copy_file(seed, out, fs::copy_options::overwrite_existing);
  constexpr std::size_t kMostEdits = 12;
  const Id file{H5Fopen(out.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose};
  for (std::size_t i = 0; i < std::min(kMostEdits, bytes.size() / sizeof(Edit)); ++i) {
    Edit edit;
    std::memcpy(&edit, bytes.data() + i * sizeof edit, sizeof edit);
    apply(file, edit);
  }
  return out.string();
}

}  // namespace palpate::fuzz
