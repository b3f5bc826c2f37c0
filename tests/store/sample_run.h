#pragma once

#include <filesystem>
#include <string>

#include "palpate/store/run_file.h"
#include "temporary_folder.h"

/// A small synthetic run in which every number follows from its step, so that a file's content can be checked
/// without a second copy.
namespace sample_run {

using namespace palpate;

/// A temporary folder that is removed with its owner.
class Folder {
 public:
  std::string operator/(const std::string& name) const { return (folder_ / name).string(); }

 private:
  TemporaryFolder folder_;
};

/// Two tetrahedra with five nodes, and a triangle as the tool.
inline std::vector<store::RunPart> parts() {
  store::RunPart body{.name = "ball", .reference = Points(3, 5), .tets = Tets(4, 2), .faces = Faces(3, 0)};
  body.reference << 0, 1, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 0, 1, 1;
  body.tets << 0, 1, 1, 2, 2, 3, 3, 4;
  store::RunPart tool{.name = "tool", .reference = Points(3, 3), .tets = Tets(4, 0), .faces = Faces(3, 1)};
  tool.reference << 0, 1, 0, 0, 0, 1, 2, 2, 2;
  tool.faces << 0, 1, 2;
  return {body, tool};
}

inline constexpr int kPoints = 8;

inline double time(int step) { return 0.25 * step; }
inline Points reference() {
  Points all(3, kPoints);
  all << parts()[0].reference, parts()[1].reference;
  return all;
}
inline Points displacement(int step) { return Points::Constant(3, kPoints, 0.5 * step); }
inline Points points(int step) { return reference() + displacement(step); }
inline Points velocity(int step) { return Points::Constant(3, kPoints, -1.0 * step); }
inline VecX stress(int step) { return VecX::LinSpaced(kPoints, 0.0, 7.0).array() + 10.0 * step; }

inline void append(store::RunFile& file, int step) {
  file.append(time(step), points(step), velocity(step), stress(step));
}

inline store::RunInfo info(int expected_steps) {
  return {.scene_name = "sample",
          .scene_source = "[scene]\nname = \"sample\" # caf\xc3\xa9\n",
          .version = "0.0.0 test",
          .expected_steps = expected_steps};
}

}  // namespace sample_run
