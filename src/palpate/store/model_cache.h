#pragma once
#include <string>

namespace palpate::store {

/// Scenes name models that palpate makes from formulas by "model:NAME" in place of a file.  They are made
/// once and kept: in $PALPATE_MODELS, else $XDG_CACHE_HOME/palpate, else ~/.cache/palpate, by version.

/// "model:head": "head"; empty where the name is a file's.
std::string model_of(const std::string& file);
/// Where that model is kept, or will be.
/// @throws Error where there is no home to keep it in
std::string cached_model(const std::string& name);
/// The name of the model that is kept at that path, "head"; empty where the path is not one of the cache.
std::string name_of_cached(const std::string& path);

}  // namespace palpate::store
