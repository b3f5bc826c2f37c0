#pragma once
#include <string>
#include <vector>

#include "palpate/core/pose.h"
#include "palpate/store/csv.h"

namespace palpate::store {

/// One bone at one recorded instant: where it is, and what the tissue exerts on it.
struct BoneRow {
  double time_s = 0.0;
  int bone = 0;  ///< in the order of the scene, from 0
  Pose pose;
  Twist twist;
  Wrench from_tissue;  ///< moment about the bone's origin
};

/// Headers of bones.csv, units included.
const std::vector<std::string>& bone_headers();

/// bones.csv, a line a bone and recorded instant.
class BoneFile {
 public:
  explicit BoneFile(const std::string& path) : csv_(path, bone_headers()) {}
  /// Goes on with a file, as CsvWriter does.
  BoneFile(const std::string& path, const CsvWriter::Place& place) : csv_(path, bone_headers(), place) {}
  CsvWriter::Place place() { return csv_.place(); }
  void append(const BoneRow& row);
  void flush() { csv_.flush(); }

 private:
  CsvWriter csv_;
};

std::vector<BoneRow> read_bones(const std::string& path);

}  // namespace palpate::store
