#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "palpate/core/pose.h"
#include "store/csv.h"

namespace palpate::store {

/// Record of one haptic tick: poses of handle and tool, and the wrench that the device displays.
struct ForceRow {
  double time_s = 0.0;  ///< [s]
  Pose handle, tool;
  Wrench on_hand;              ///< Wrench after the device's limits, moment about the handle's origin.
  bool limited = false;        ///< The requested wrench exceeded the device's maximum.
  std::uint32_t switches = 0;  ///< Switches of the handle: bit i is 1 where switch i is pressed.
};

/// Returns the headers of force.csv, units included.
const std::vector<std::string>& force_headers();

/// Writer of force.csv, one line per tick.
class ForceFile {
 public:
  explicit ForceFile(const std::string& path) : csv_(path, force_headers()) {}
  /// Resumes a file, as CsvWriter does.
  ForceFile(const std::string& path, const CsvWriter::Place& place) : csv_(path, force_headers(), place) {}
  CsvWriter::Place place() { return csv_.place(); }
  const std::string& path() const { return csv_.path(); }
  void append(const ForceRow& row);
  void flush() { csv_.flush(); }
  void close() { csv_.close(); }

 private:
  CsvWriter csv_;
};

/// Reads force.csv.  @throws Error where the file is missing or malformed
std::vector<ForceRow> read_forces(const std::string& path);

}  // namespace palpate::store
