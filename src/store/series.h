#pragma once
#include "store/h5.h"

namespace palpate::store {

/// Data set that holds the same number of rows for each step.  Its space is allocated in the file when it is
/// reserved, so that writing a step touches only the bytes of that step.
class Series {
 public:
  /// Creates the data set with space for `capacity` steps.
  /// @param rows  number of rows per step
  /// @param width  columns; 0: the data set has one dimension
  /// @param units  attribute, may be empty
  Series(hid_t parent, const std::string& name, hid_t type, hsize_t rows, hsize_t width, hsize_t capacity,
         const std::string& units, const std::string& path);
  void write(hsize_t step, const void* data);  ///< rows x width values of the type; step < capacity.
  void resize(hsize_t capacity);

 private:
  hid_t type_;
  hsize_t rows_, width_;
  std::string name_, path_;
  h5::Id set_;
};

}  // namespace palpate::store
