#include "missing_models.h"

#include <filesystem>

#include "palpate/core/error.h"
#include "palpate/scene/hands.h"
#include "store/model_cache.h"

namespace palpate::python {
namespace {

void refuse_missing(const std::string& file) {
  const std::string name = store::name_of_cached(file);
  if (!name.empty() && !std::filesystem::exists(file))
    fail(
        "the model \"{}\" has not been made yet; run `palpate model {} -o {}` once, or run the scene with "
        "`palpate run`",
        name, name, file);
}

}  // namespace

void refuse_missing_models(const scene::Description& description) {
  for (const SoftBodySpec& body : description.bodies) refuse_missing(body.mesh.file);
  for (const scene::Hand& hand : scene::hands_of(description))
    if (hand.tool) refuse_missing(hand.tool->mesh.file);
}

}  // namespace palpate::python
