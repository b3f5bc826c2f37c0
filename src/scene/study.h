#pragma once
#include <string>
#include <vector>

#include "palpate/scene/kinds.h"
#include "scene/study_spec.h"

/// Study as specified by its file: scenes x integrators x tolerances x swept parameters x seeds.  Plain data;
/// study/plan.h makes tasks of it.
namespace palpate::scene {

/// Reads and checks a study given as text.  Whether the swept keys exist is checked with the scenes.
/// @throws Error as for scenes: `FILE:LINE:COLUMN: where: what`, with the nearest known key
StudySpec parse_study(const std::string& text, const std::string& path);
/// Reads and checks a study file.  @throws Error as parse_study(), or where the file cannot be read
StudySpec load_study(const std::string& path);

/// Returns every key that a study may contain, table by table: `palpate list study-keys`.
std::vector<KeyRow> study_key_rows();

/// Returns the value that a seed draws for a key, as TOML with six significant digits.  It depends only on
/// seed, key and distribution, not on the scene, the integrator or other drawn values, so that compared runs
/// have the same bodies.  std::mt19937_64 seeded by std::seed_seq of the seed and the key's bytes; both give
/// the same sequence on every machine (C++20, [rand.eng.mers], [rand.util.seedseq]).
/// @throws Error for a normal distribution that hardly ever falls between its min and max
std::string drawn_value(const RandomSpec& random, int seed);

}  // namespace palpate::scene
