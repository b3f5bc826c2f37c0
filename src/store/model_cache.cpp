#include "store/model_cache.h"

#include <cstdlib>
#include <filesystem>
#include <string_view>

#include "palpate/core/error.h"
#include "store/provenance.h"

namespace palpate::store {
namespace {

std::filesystem::path cache_folder() {
  const auto set = [](const char* name) -> const char* {
    const char* value = std::getenv(name);
    return value != nullptr && *value != '\0' ? value : nullptr;
  };
  if (const char* own = set("PALPATE_MODELS")) return std::filesystem::absolute(own);
  if (const char* cache = set("XDG_CACHE_HOME")) return std::filesystem::path(cache) / "palpate";
  if (const char* home = set("HOME")) return std::filesystem::path(home) / ".cache" / "palpate";
  fail("there is no folder for the cache of models; set PALPATE_MODELS, XDG_CACHE_HOME or HOME");
}

}  // namespace

std::string model_of(const std::string& file) {
  constexpr std::string_view kPrefix = "model:";
  return file.starts_with(kPrefix) ? file.substr(kPrefix.size()) : std::string();
}

std::string cached_model(const std::string& name) {
  return (cache_folder() / version() / (name + ".h5")).string();
}

std::string name_of_cached(const std::string& path) {
  const std::filesystem::path file = path;
  if (!file.is_absolute() || file.extension() != ".h5") return {};
  try {
    return file.parent_path() == cache_folder() / version() ? file.stem().string() : std::string();
  } catch (const Error&) { return {}; }  // Without a cache no file belongs to it.
}

}  // namespace palpate::store
