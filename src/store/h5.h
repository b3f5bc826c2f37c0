#pragma once
#include <hdf5.h>

#include <string>
#include <utility>
#include <vector>

/// Functions of HDF5 that palpate uses, with RAII owners, and errors that contain the file and the failed
/// operation.
namespace palpate::store::h5 {

/// Scope in which HDF5 does not print its errors on standard error, as it does by default; palpate reports
/// them instead.
class Quiet {
 public:
  Quiet();
  ~Quiet();
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

/// Owner of one HDF5 identifier.  Closing it may write, and fail on a full disk: flush first where such a
/// failure must be detected.
class Id {
 public:
  using Close = herr_t (*)(hid_t);
  Id() = default;
  Id(hid_t id, Close close) : id_(id), close_(close) {}
  Id(Id&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  Id& operator=(Id&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~Id() {
    if (id_ < 0) return;
    const Quiet quiet;
    close_(id_);
  }
  operator hid_t() const { return id_; }

 private:
  hid_t id_ = H5I_INVALID_HID;
  Close close_ = nullptr;
};

/// Throws Error `PATH: what: HDF5's message`.
[[noreturn]] void fail_at(const std::string& path, const std::string& what);
/// Returns a valid identifier or status unchanged; otherwise calls fail_at.
hid_t check(hid_t id, const std::string& path, const std::string& what);

/// Creates a file, replacing an existing one.
Id create_file(const std::string& path);
Id open_file(const std::string& path);  ///< Opens for reading.
/// Creates a file in memory; `path` is its name in messages.  image() returns its bytes when all is written.
Id create_in_memory(const std::string& path);
std::string image(hid_t file, const std::string& path);
Id create_group(hid_t parent, const std::string& name, const std::string& path);

/// Writes a data set at once, without time stamps.  `type` is the type in memory and in the file.
void write(hid_t parent, const std::string& name, hid_t type, const std::vector<hsize_t>& shape,
           const void* data, const std::string& path);
void write_text(hid_t parent, const std::string& name, const std::string& text, const std::string& path);
void write_attribute(hid_t object, const std::string& name, hid_t type, const std::vector<hsize_t>& shape,
                     const void* data, const std::string& path);
void write_attribute_text(hid_t object, const std::string& name, const std::string& text,
                          const std::string& path);

/// Data set opened for reading, with checked type class and number of dimensions.
struct Opened {
  Id id;
  std::vector<hsize_t> shape;
};
Opened open(hid_t parent, const std::string& name, H5T_class_t type_class, std::size_t rank,
            const std::string& path);
/// Reads a whole data set; `out` must have room for it.
void read(const Opened& data, const std::string& name, hid_t type, void* out, const std::string& path);
/// Reads rows [first, first + count) of a data set.
void read_rows(const Opened& data, const std::string& name, hid_t type, hsize_t first, hsize_t count,
               void* out, const std::string& path);
std::string read_text(hid_t parent, const std::string& name, const std::string& path);
std::string read_attribute_text(hid_t object, const std::string& name, const std::string& path);
long long read_attribute_integer(hid_t object, const std::string& name, const std::string& path);

}  // namespace palpate::store::h5
