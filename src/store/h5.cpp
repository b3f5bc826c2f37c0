#include "store/h5.h"

#include <filesystem>

#include "palpate/core/error.h"

namespace palpate::store::h5 {
namespace {

/// Disables HDF5's clean-up at exit, which crashes after a failed write (a full disk).  It is not needed,
/// because every handle here has an owner that closes it.  Must precede any other call of HDF5.
[[maybe_unused]] const herr_t kNoCleanUpAtExit = H5dont_atexit();

herr_t take_description(unsigned n, const H5E_error2_t* error, void* out) {
  if (n == 0 && error->desc) *static_cast<std::string*>(out) = error->desc;
  return 0;
}

/// Returns HDF5's error message nearest to the cause.
std::string reason() {
  std::string text;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, take_description, &text);
  H5Eclear2(H5E_DEFAULT);
  const std::string quote = "error message = '";  // In a description of several lines, with addresses.
  if (const std::size_t at = text.find(quote); at != std::string::npos) {
    text.erase(0, at + quote.size());
    text.resize(std::min(text.size(), text.find('\'')));
  }
  return text.empty() ? "" : ": " + text;
}

herr_t look_for_lock(unsigned, const H5E_error2_t* error, void* found) {
  if (error->min_num == H5E_CANTLOCKFILE) *static_cast<bool*>(found) = true;
  return 0;
}

/// Whether the last call failed at the lock of another process.  errno is no indication: HDF5 1.14 (Debian
/// 13) searches for the file elsewhere afterwards, and leaves ENOENT.
bool failed_at_lock() {
  bool found = false;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, look_for_lock, &found);
  return found;
}

Id space_of(const std::vector<hsize_t>& shape) {
  if (shape.empty()) return {H5Screate(H5S_SCALAR), H5Sclose};
  return {H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose};
}

/// Returns a string type of fixed length, as VTK requires for attributes; H5T_STR_NULLPAD needs at least one
/// byte.
Id text_type(std::size_t size) {
  Id type{H5Tcopy(H5T_C_S1), H5Tclose};
  H5Tset_size(type, size == 0 ? 1 : size);
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  H5Tset_cset(type, H5T_CSET_ASCII);
  return type;
}

/// Returns access properties with optional locking: file locks fail on some network folders, and the files
/// stay consistent without them.
Id access_without_need_of_locks() {
  Id access{H5Pcreate(H5P_FILE_ACCESS), H5Pclose};
  H5Pset_file_locking(access, true, true);
  return access;
}

/// Returns creation properties without time stamps, so that equal content gives equal bytes.
Id created_without_time(hid_t kind) {
  Id creation{H5Pcreate(kind), H5Pclose};
  H5Pset_obj_track_times(creation, false);
  return creation;
}

std::string text_of(hid_t type, const std::vector<char>& raw) {
  const bool fixed = H5Tis_variable_str(type) == 0;
  std::string text(raw.data(), raw.size());
  if (fixed) text.resize(std::min(text.size(), text.find_last_not_of('\0') + 1));
  return text;
}

}  // namespace

Quiet::Quiet() {
  H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}
Quiet::~Quiet() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }

void fail_at(const std::string& path, const std::string& what) { fail("{}: {}{}", path, what, reason()); }

hid_t check(hid_t id, const std::string& path, const std::string& what) {
  if (id < 0) fail_at(path, what);
  return id;
}

Id create_file(const std::string& path) {
  const Id access = access_without_need_of_locks();
  return {check(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access), path,
                "cannot be written; check that its folder exists, is writable and is not full"),
          H5Fclose};
}

Id open_file(const std::string& path) {
  if (!std::filesystem::is_regular_file(path)) fail("{}: no such file", path);
  const Id access = access_without_need_of_locks();
  Id file{H5Fopen(path.c_str(), H5F_ACC_RDONLY, access), H5Fclose};
  if (file < 0 && failed_at_lock())
    fail("{}: is being written by another process; wait until it has ended", path);
  check(file, path, "is not an HDF5 file that can be read; check that it is complete");
  return file;
}

Id create_in_memory(const std::string& path) {
  const Id access = access_without_need_of_locks();
  constexpr std::size_t kGrowth = 1 << 20;
  H5Pset_fapl_core(access, kGrowth, false);
  return {
      check(H5Fcreate("in memory", H5F_ACC_TRUNC, H5P_DEFAULT, access), path, "cannot be created in memory"),
      H5Fclose};
}

std::string image(hid_t file, const std::string& path) {
  check(H5Fflush(file, H5F_SCOPE_LOCAL), path, "cannot be flushed");
  const ssize_t size = H5Fget_file_image(file, nullptr, 0);
  check(size, path, "has no size");
  std::string bytes(static_cast<std::size_t>(size), '\0');
  check(H5Fget_file_image(file, bytes.data(), bytes.size()), path, "cannot be copied");
  return bytes;
}

Id create_group(hid_t parent, const std::string& name, const std::string& path) {
  const Id timeless = created_without_time(H5P_GROUP_CREATE);
  return {check(H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, timeless, H5P_DEFAULT), path,
                "cannot create group " + name),
          H5Gclose};
}

void write(hid_t parent, const std::string& name, hid_t type, const std::vector<hsize_t>& shape,
           const void* data, const std::string& path) {
  const Id space = space_of(shape);
  const Id timeless = created_without_time(H5P_DATASET_CREATE);
  const Id set{check(H5Dcreate2(parent, name.c_str(), type, space, H5P_DEFAULT, timeless, H5P_DEFAULT), path,
                     "cannot create " + name),
               H5Dclose};
  if (H5Sget_simple_extent_npoints(space) > 0)
    check(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data), path, "cannot write " + name);
}

void write_text(hid_t parent, const std::string& name, const std::string& text, const std::string& path) {
  const Id type = text_type(text.size());
  write(parent, name, type, {}, text.c_str(), path);
}

void write_attribute(hid_t object, const std::string& name, hid_t type, const std::vector<hsize_t>& shape,
                     const void* data, const std::string& path) {
  const Id space = space_of(shape);
  const Id attribute{check(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), path,
                           "cannot create attribute " + name),
                     H5Aclose};
  check(H5Awrite(attribute, type, data), path, "cannot write attribute " + name);
}

void write_attribute_text(hid_t object, const std::string& name, const std::string& text,
                          const std::string& path) {
  const Id type = text_type(text.size());
  write_attribute(object, name, type, {}, text.c_str(), path);
}

namespace {

/// Checks sizes against the bytes in the file before memory is allocated for them: a damaged file may hold
/// any size.
void check_room(const Opened& set, std::size_t size_of_one, H5T_class_t type_class, hid_t parent,
                const std::string& name, const std::string& path) {
  constexpr std::size_t kLargestNumber = 16;
  constexpr double kMostCompressed = 1100;  // Deflate reaches 1032.
  if (type_class != H5T_STRING && size_of_one > kLargestNumber)
    fail("{}: \"{}\" has numbers of {} bytes; the file is damaged", path, name, size_of_one);
  double bytes = static_cast<double>(size_of_one);
  for (const hsize_t n : set.shape) bytes *= static_cast<double>(n);
  hsize_t in_file = 0;
  const Id file{H5Iget_file_id(parent), H5Fclose};
  H5Fget_filesize(file, &in_file);
  if (bytes > kMostCompressed * static_cast<double>(in_file))
    fail("{}: \"{}\" declares {:.3g} bytes, but the file has {}; it is damaged", path, name, bytes, in_file);
}

}  // namespace

Opened open(hid_t parent, const std::string& name, H5T_class_t type_class, std::size_t rank,
            const std::string& path) {
  if (H5Lexists(parent, name.c_str(), H5P_DEFAULT) <= 0) fail("{}: has no data set \"{}\"", path, name);
  Opened out;
  out.id = Id{check(H5Dopen2(parent, name.c_str(), H5P_DEFAULT), path, "cannot open " + name), H5Dclose};
  const Id type{H5Dget_type(out.id), H5Tclose};
  const Id space{H5Dget_space(out.id), H5Sclose};
  if (H5Tget_class(type) != type_class)
    fail("{}: \"{}\" must hold {}", path, name,
         type_class == H5T_FLOAT     ? "floating-point numbers"
         : type_class == H5T_INTEGER ? "integers"
                                     : "text");
  const int dimensions = H5Sget_simple_extent_ndims(space);
  if (dimensions != static_cast<int>(rank))
    fail("{}: \"{}\" has {} dimensions, must have {}", path, name, dimensions, rank);
  out.shape.resize(rank);
  if (rank > 0) H5Sget_simple_extent_dims(space, out.shape.data(), nullptr);
  check_room(out, H5Tget_size(type), type_class, parent, name, path);
  return out;
}

void read(const Opened& data, const std::string& name, hid_t type, void* out, const std::string& path) {
  check(H5Dread(data.id, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, out), path, "cannot read " + name);
}

void read_rows(const Opened& data, const std::string& name, hid_t type, hsize_t first, hsize_t count,
               void* out, const std::string& path) {
  if (first + count > data.shape.at(0))
    fail("{}: \"{}\" ends at row {}, must reach {}; the file is damaged", path, name, data.shape[0],
         first + count);
  if (count == 0) return;
  std::vector<hsize_t> start(data.shape.size(), 0), size = data.shape;
  start[0] = first;
  size[0] = count;
  const Id in_file{H5Dget_space(data.id), H5Sclose};
  const Id in_memory = space_of(size);
  H5Sselect_hyperslab(in_file, H5S_SELECT_SET, start.data(), nullptr, size.data(), nullptr);
  check(H5Dread(data.id, type, in_memory, in_file, H5P_DEFAULT, out), path, "cannot read " + name);
}

std::string read_text(hid_t parent, const std::string& name, const std::string& path) {
  const Opened set = open(parent, name, H5T_STRING, 0, path);
  const Id type{H5Dget_type(set.id), H5Tclose};
  if (H5Tis_variable_str(type) > 0) fail("{}: \"{}\" must be a string of fixed length", path, name);
  std::vector<char> raw(H5Tget_size(type));
  read(set, name, type, raw.data(), path);
  return text_of(type, raw);
}

std::string read_attribute_text(hid_t object, const std::string& name, const std::string& path) {
  const Id attribute{check(H5Aopen(object, name.c_str(), H5P_DEFAULT), path, "has no attribute " + name),
                     H5Aclose};
  const Id type{H5Aget_type(attribute), H5Tclose};
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0)
    fail("{}: attribute \"{}\" must be a string of fixed length", path, name);
  std::vector<char> raw(H5Tget_size(type));
  check(H5Aread(attribute, type, raw.data()), path, "cannot read attribute " + name);
  return text_of(type, raw);
}

long long read_attribute_integer(hid_t object, const std::string& name, const std::string& path) {
  const Id attribute{check(H5Aopen(object, name.c_str(), H5P_DEFAULT), path, "has no attribute " + name),
                     H5Aclose};
  const Id space{H5Aget_space(attribute), H5Sclose};
  if (H5Sget_simple_extent_npoints(space) != 1) fail("{}: attribute \"{}\" must be one integer", path, name);
  long long value = 0;
  check(H5Aread(attribute, H5T_NATIVE_LLONG, &value), path, "cannot read attribute " + name);
  return value;
}

}  // namespace palpate::store::h5
