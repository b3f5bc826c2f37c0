#pragma once
#include "palpate/scene/kinds.h"

namespace palpate::fuzz {

/// Names known to the scene target. Devices, motions and generators use the full registries. Integrators,
/// solvers, contact and obstacles are a few examples of each: their registries would pull nearly all of
/// palpate into the fuzzer's build. tests/scene reads the same corpus with all names.
const scene::Kinds& scene_kinds();

}  // namespace palpate::fuzz
