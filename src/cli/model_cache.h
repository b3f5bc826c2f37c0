#pragma once
#include "palpate/scene/description.h"

namespace palpate::cli {

/// Makes the models that a scene names by "model:NAME" and that are not kept yet, by the program behind
/// `palpate model`; says which, and where they are kept.
/// @throws Error where it was not made (that program has said why: no such model, for one), or this build
///   makes none
void make_missing_models(const scene::Description& description);

}  // namespace palpate::cli
