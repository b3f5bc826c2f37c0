#pragma once
#include "model_arguments.h"

namespace palpate::cli {

/// Rejects a model whose estimated memory exceeds the available memory, before it is built.
/// @throws Error with both figures, unless --beyond-memory was given
void refuse_beyond_memory(const ModelArguments& arguments, const model::Input& input);

}  // namespace palpate::cli
