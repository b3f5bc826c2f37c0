#pragma once
#include <pybind11/numpy.h>

#include <memory>
#include <utility>
#include <vector>

#include "palpate/core/types.h"

/// Read-only NumPy arrays that are views of C++ memory: nothing is copied.
namespace palpate::python {

/// Makes a read-only array that is a view of `data`.
/// @param shape, strides  per dimension, rows first; strides in bytes
/// @param owner  Python object that keeps the memory alive; the array holds a reference to it
template <class T>
pybind11::array view(const T* data, std::vector<pybind11::ssize_t> shape,
                     std::vector<pybind11::ssize_t> strides, const pybind11::handle& owner) {
  const pybind11::array out(pybind11::dtype::of<T>(), std::move(shape), std::move(strides), data, owner);
  out.attr("setflags")(false);
  return out;
}

/// Makes an array of n values.
template <class T>
pybind11::array rows(const T* data, pybind11::ssize_t n, const pybind11::handle& owner) {
  return view(data, {n}, {sizeof(T)}, owner);
}

/// Makes an array of n contiguous rows with `width` values: the transpose of a column-major matrix with
/// `width` rows.
template <class T>
pybind11::array rows(const T* data, pybind11::ssize_t n, pybind11::ssize_t width,
                     const pybind11::handle& owner) {
  constexpr pybind11::ssize_t size = sizeof(T);
  return view(data, {n, width}, {width * size, size}, owner);
}

/// Makes an array of three numbers, a copy.
inline pybind11::array copied(const Vec3& v) { return pybind11::array_t<double>(3, v.data()); }

/// Makes an array of a unit quaternion: w, x, y, z.
inline pybind11::array copied(const Quat& q) {
  const double numbers[] = {q.w(), q.x(), q.y(), q.z()};
  return pybind11::array_t<double>(4, numbers);
}

/// Keeps a value alive as long as arrays refer to it; get() returns it at its final address.
template <class T>
class Kept {
 public:
  explicit Kept(T value) : value_(new T(std::move(value))) {
    owner_ = pybind11::capsule(value_, [](void* p) { delete static_cast<T*>(p); });
  }
  const T& get() const { return *value_; }
  const pybind11::capsule& owner() const { return owner_; }

 private:
  T* value_;
  pybind11::capsule owner_;
};

}  // namespace palpate::python
