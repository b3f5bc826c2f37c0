#pragma once
#include "palpate/scene/description.h"

namespace palpate::python {

/// Checks that all models exist.  The program generates models on first use ("model:gear"); the module uses
/// existing ones only.
/// @throws Error with the command to run, for a model that does not exist yet
void refuse_missing_models(const scene::Description& description);

}  // namespace palpate::python
