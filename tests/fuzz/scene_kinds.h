#pragma once
#include "palpate/scene/kinds.h"

namespace palpate::fuzz {

/// The names that the scene target knows.  Those of devices, motions and generators are the registries' own.
/// Integrators, solvers, contact and obstacles are a few of each sort: their registries would bring nearly
/// all of palpate into the fuzzer's build.  tests/scene reads the same corpus with all of them.
const scene::Kinds& scene_kinds();

}  // namespace palpate::fuzz
