#include "store/checkpoint_file.h"

#include <filesystem>

#include "core/sandbox.h"
#include "palpate/core/error.h"
#include "store/atomic_file.h"
#include "store/content_hash.h"
#include "store/h5.h"

// Group "state" holds one data set per value: doubles, 64-bit integers, or bytes, in alphabetical order.  The
// attribute "content" is a hash of all of them, of the time and of the scene: it detects damage that HDF5
// does not (a byte that changed on the disk) before any value is used.  The version is not part of the hash:
// a checkpoint of another version is rejected as such.
namespace palpate::store {
namespace {

constexpr const char* kWhat = "palpate checkpoint 1";

template <class T>
std::string_view bytes_of(const std::vector<T>& list) {
  return {reinterpret_cast<const char*>(list.data()), list.size() * sizeof(T)};
}

std::string hash_of(const Checkpoint& checkpoint) {
  ContentHash hash;
  hash.add(checkpoint.scene_source);
  hash.add(bytes_of(std::vector<double>{checkpoint.time_s}));
  for (const auto& [name, value] : checkpoint.values) {
    hash.add(name);
    if (const auto* numbers = std::get_if<std::vector<double>>(&value))
      hash.add("numbers").add(bytes_of(*numbers));
    else if (const auto* integers = std::get_if<std::vector<std::int64_t>>(&value))
      hash.add("integers").add(bytes_of(*integers));
    else
      hash.add("bytes").add(std::get<std::string>(value));
  }
  return hash.hex();
}

struct ValueWriter {
  hid_t group;
  const std::string& name;
  const std::string& path;
  void operator()(const std::vector<double>& list) const {
    h5::write(group, name, H5T_NATIVE_DOUBLE, {list.size()}, list.data(), path);
  }
  void operator()(const std::vector<std::int64_t>& list) const {
    h5::write(group, name, H5T_NATIVE_INT64, {list.size()}, list.data(), path);
  }
  void operator()(const std::string& bytes) const {
    h5::write(group, name, H5T_NATIVE_UINT8, {bytes.size()}, bytes.data(), path);
  }
};

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
  fail("{}: is not a valid checkpoint: {}; run the scene again", path, why);
}

Archive::Value read_value(hid_t group, const std::string& name, const std::string& path) {
  const h5::Id set{h5::check(H5Dopen2(group, name.c_str(), H5P_DEFAULT), path, "cannot open " + name),
                   H5Dclose};
  const h5::Id type{H5Dget_type(set), H5Tclose};
  const h5::Id space{H5Dget_space(set), H5Sclose};
  const hssize_t size = H5Sget_simple_extent_npoints(space);
  const std::size_t stored = H5Dget_storage_size(set), width = H5Tget_size(type);
  // Contiguous data are stored as they are: a size beyond the file is damage, and must not allocate memory.
  if (size < 0 || static_cast<std::size_t>(size) > stored / std::max<std::size_t>(width, 1))
    refuse(path, fmt::format("\"{}\" is truncated", name));
  const auto read = [&]<class T>(T list, hid_t memory) {
    list.resize(static_cast<std::size_t>(size));
    if (size > 0)
      h5::check(H5Dread(set, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, list.data()), path,
                "cannot read " + name);
    return Archive::Value(std::move(list));
  };
  if (H5Tget_class(type) == H5T_FLOAT && width == 8) return read(std::vector<double>(), H5T_NATIVE_DOUBLE);
  if (H5Tget_class(type) == H5T_INTEGER && width == 8)
    return read(std::vector<std::int64_t>(), H5T_NATIVE_INT64);
  if (H5Tget_class(type) == H5T_INTEGER && width == 1) return read(std::string(), H5T_NATIVE_UINT8);
  refuse(path, fmt::format("\"{}\" holds neither numbers nor bytes", name));
}

double read_time(hid_t file, const std::string& path) {
  const h5::Opened set = h5::open(file, "time_s", H5T_FLOAT, 0, path);
  double time = 0.0;
  h5::read(set, "time_s", H5T_NATIVE_DOUBLE, &time, path);
  return time;
}

std::vector<std::string> names_in(hid_t group, const std::string& path) {
  H5G_info_t info{};
  h5::check(H5Gget_info(group, &info), path, "has no list of its state");
  std::vector<std::string> out;
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    const ssize_t length =
        H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, nullptr, 0, H5P_DEFAULT);
    if (length < 0) refuse(path, "a name in it cannot be read");
    std::string name(static_cast<std::size_t>(length) + 1, '\0');
    if (H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, name.data(), name.size(), H5P_DEFAULT) <
        0)
      refuse(path, "a name in it cannot be read");
    name.pop_back();
    out.push_back(std::move(name));
  }
  return out;
}

}  // namespace

void write_checkpoint(const std::string& path, const Checkpoint& checkpoint) {
  const h5::Quiet quiet;
  const h5::Id file = h5::create_in_memory(path);
  h5::write_attribute_text(file, "what", kWhat, path);
  h5::write_attribute_text(file, "version", checkpoint.version, path);
  h5::write_attribute_text(file, "content", hash_of(checkpoint), path);
  h5::write(file, "time_s", H5T_NATIVE_DOUBLE, {}, &checkpoint.time_s, path);
  h5::write(file, "scene", H5T_NATIVE_UINT8, {checkpoint.scene_source.size()}, checkpoint.scene_source.data(),
            path);
  {
    const h5::Id state = h5::create_group(file, "state", path);
    for (const auto& [name, value] : checkpoint.values) std::visit(ValueWriter{state, name, path}, value);
  }
  write_durably(path, h5::image(file, path));
}

namespace {
Checkpoint checkpoint_in(const std::string& path) {
  const h5::Quiet quiet;
  Checkpoint out;
  std::string content;
  try {
    const h5::Id file = h5::open_file(path);
    if (H5Aexists(file, "what") <= 0 || h5::read_attribute_text(file, "what", path) != kWhat)
      fail("it is a different kind of file");
    out.version = h5::read_attribute_text(file, "version", path);
    content = h5::read_attribute_text(file, "content", path);
    out.time_s = read_time(file, path);
    out.scene_source = std::get<std::string>(read_value(file, "scene", path));
    const h5::Id state{h5::check(H5Gopen2(file, "state", H5P_DEFAULT), path, "has no state"), H5Gclose};
    for (const std::string& name : names_in(state, path)) out.values[name] = read_value(state, name, path);
  } catch (const Error& error) { refuse(path, error.what()); } catch (const std::bad_variant_access&) {
    refuse(path, "its scene is not text");
  }
  if (hash_of(out) != content) refuse(path, "its content differs from what was written");
  return out;
}
}  // namespace

Checkpoint read_checkpoint(const std::string& path) {
  if (!std::filesystem::is_regular_file(path)) fail("{}: no such file", path);
  return rehearsed(path, "HDF5", [&] { return checkpoint_in(path); });
}

}  // namespace palpate::store
