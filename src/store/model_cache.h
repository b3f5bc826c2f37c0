#pragma once
#include <string>

namespace palpate::store {

/// Cache of models that palpate generates from formulas, which scenes reference by "model:NAME" instead of a
/// file. Folder: $PALPATE_MODELS, else $XDG_CACHE_HOME/palpate, else ~/.cache/palpate, each with a subfolder
/// per version.

/// Returns the name from such a reference, "head" from "model:head"; empty where `file` is a file name.
std::string model_of(const std::string& file);
/// Returns the path of that model in the cache, whether or not it exists yet.
/// @throws Error where none of these folders is defined
std::string cached_model(const std::string& name);
/// Returns the name of the model cached at that path, "head"; empty where the path is outside the cache.
std::string name_of_cached(const std::string& path);

}  // namespace palpate::store
