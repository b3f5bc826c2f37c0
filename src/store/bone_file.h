#pragma once
#include <string>
#include <vector>

#include "palpate/core/pose.h"
#include "store/csv.h"

namespace palpate::store {

/// State of one bone at one recorded time, with the load that tissue exerts on it.
struct BoneRow {
  double time_s = 0.0;  ///< [s]
  int bone = 0;         ///< Index of the bone in the scene.
  Pose pose;            ///< Pose of the bone in the world.
  Twist twist;          ///< Velocity of the bone.
  Wrench from_tissue;   ///< Load by tissue, moment about the bone's origin.
};

/// Returns the headers of bones.csv, units included.
const std::vector<std::string>& bone_headers();

/// Writer of bones.csv, one line per bone and recorded time.
class BoneFile {
 public:
  explicit BoneFile(const std::string& path) : csv_(path, bone_headers()) {}
  /// Resumes a file, as CsvWriter does.
  BoneFile(const std::string& path, const CsvWriter::Place& place) : csv_(path, bone_headers(), place) {}
  CsvWriter::Place place() { return csv_.place(); }
  void append(const BoneRow& row);
  void flush() { csv_.flush(); }

 private:
  CsvWriter csv_;
};

/// Reads bones.csv.  @throws Error where the file is missing or malformed
std::vector<BoneRow> read_bones(const std::string& path);

}  // namespace palpate::store
