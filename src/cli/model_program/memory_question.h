#pragma once
#include "options.h"

namespace palpate::cli {

/// A model that needs more memory than there is, by what is asked for, is refused before it is begun.
/// @throws Error with both figures, unless --beyond-memory was said
void refuse_beyond_memory(const ModelArguments& arguments, const model::Input& input);

}  // namespace palpate::cli
