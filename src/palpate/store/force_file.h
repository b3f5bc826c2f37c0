#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "palpate/core/pose.h"
#include "palpate/store/csv.h"

namespace palpate::store {

/// One haptic tick: where hand and tool are, and what the hand feels.
struct ForceRow {
  double time_s = 0.0;
  Pose handle, tool;
  Wrench on_hand;              ///< after the device's limits, moment about the handle's origin
  bool limited = false;        ///< the wrench wanted was above the device's maximum
  std::uint32_t switches = 0;  ///< of the handle: bit i is 1 where switch i is pressed
};

/// Headers of force.csv, units included.
const std::vector<std::string>& force_headers();

/// force.csv, one line a tick.
class ForceFile {
 public:
  explicit ForceFile(const std::string& path) : csv_(path, force_headers()) {}
  /// Goes on with a file, as CsvWriter does.
  ForceFile(const std::string& path, const CsvWriter::Place& place) : csv_(path, force_headers(), place) {}
  CsvWriter::Place place() { return csv_.place(); }
  const std::string& path() const { return csv_.path(); }
  void append(const ForceRow& row);
  void flush() { csv_.flush(); }
  void close() { csv_.close(); }

 private:
  CsvWriter csv_;
};

std::vector<ForceRow> read_forces(const std::string& path);

}  // namespace palpate::store
