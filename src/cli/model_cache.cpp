#include "model_cache.h"

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>

#include "cli/other_program.h"
#include "palpate/core/error.h"
#include "palpate/scene/hands.h"
#include "store/model_cache.h"

namespace palpate::cli {
namespace fs = std::filesystem;
namespace {

void make_model(const std::string& name, const fs::path& path) {
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  if (error)
    fail("the model \"{}\" cannot be stored in {}: {}", name, path.parent_path().string(), error.message());
  fmt::print(stderr, "palpate: making the model \"{}\", once; stored in {}\n", name, path.string());
  // under a temporary name until it is complete: two runs may build the model at the same time
  const fs::path draft = path.parent_path() / fmt::format("{}-{}.h5", name, ::getpid());
  // in a folder of its own: a file beside the caller with the name of a shape would be taken for a surface
  const int status =
      run_silently(kModel, {name, "-o", fs::absolute(draft).string()}, path.parent_path().string());
  if (status != 0) {
    fs::remove(draft, error);
    fail("the model \"{}\" was not made; see above", name);
  }
  fs::rename(draft, path, error);
  if (error) fail("{} cannot be written: {}", path.string(), error.message());
}

}  // namespace

void make_model_at(const std::string& name, long tetrahedra, long skin_vertices, const std::string& path) {
  fmt::print(stderr, "palpate: making the model \"{}\" with {} tetrahedra\n", name, tetrahedra);
  const int status = run_silently(kModel,
                                  {name, "--tetrahedra", std::to_string(tetrahedra), "--skin-vertices",
                                   std::to_string(skin_vertices), "-o", fs::absolute(path).string()},
                                  fs::absolute(path).parent_path().string());
  if (status != 0) fail("the model \"{}\" with {} tetrahedra was not made; see above", name, tetrahedra);
}

void make_missing_models(const scene::Description& description) {
  // for "model:NAME" the loader has set a path in the cache; any other file belongs to the user
  const auto make = [](const std::string& file) {
    const fs::path path = file;
    if (const std::string name = store::name_of_cached(file); !name.empty() && !fs::exists(path))
      make_model(name, path);
  };
  for (const SoftBodySpec& body : description.bodies) make(body.mesh.file);
  for (const scene::Hand& hand : scene::hands_of(description)) make(hand.tool->mesh.file);
}

}  // namespace palpate::cli
