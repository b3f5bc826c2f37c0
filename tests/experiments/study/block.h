#pragma once
#include <string>

#include "experiments/study/plan.h"
#include "store/atomic_file.h"
#include "temporary_folder.h"

namespace palpate::study_scenes {

inline const std::string kBlock = store::read_file(PALPATE_STUDY_BLOCK);

/// A study of block.toml in a separate folder.
/// @param study  [study] without its scenes, and what follows
inline study::Plan plan_of(const TemporaryFolder& folder, const std::string& study) {
  folder.write("block.toml", kBlock);
  const auto path = folder.write("my.toml", "[study]\nscenes = [\"block.toml\"]\n" + study);
  return study::list_tasks(scene::load_study(path.string()), {});
}

}  // namespace palpate::study_scenes
