#pragma once
#include "palpate/scene/description.h"

namespace palpate::cli {

/// Builds the models that a scene specifies by "model:NAME" and that are not in the cache yet; prints their
/// names and paths. The program of `palpate model` does the work.
/// @throws Error if a model was not built (that program has printed the reason, for example an unknown
/// model), or if this build has no such program
void make_missing_models(const scene::Description& description);

/// Builds one shape at another resolution.
/// @param name  of the shape, "head"  @param path  of the new file
/// @throws Error if the model was not built
void make_model_at(const std::string& name, long tetrahedra, long skin_vertices, const std::string& path);

}  // namespace palpate::cli
