#pragma once
#include "palpate/scene/description.h"

namespace palpate::python {

/// The program makes models on first use ("model:gear"); the module only takes what is there.
/// @throws Error that names the command, for a model that was not made yet
void refuse_missing_models(const scene::Description& description);

}  // namespace palpate::python
