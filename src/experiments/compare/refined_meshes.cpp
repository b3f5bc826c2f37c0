#include "experiments/compare/refined_meshes.h"

#include <cmath>
#include <filesystem>

#include "mesh/refine.h"
#include "mesh/tet_checks.h"
#include "palpate/core/error.h"
#include "palpate/mesh/source.h"
#include "store/mesh_file.h"
#include "store/model_cache.h"
#include "store/model_file.h"
#include "store/provenance.h"

namespace palpate::compare {
namespace {

namespace fs = std::filesystem;

constexpr int kChildren = 8;

/// Returns a text that distinguishes the mesh of a generator from others.
std::string text_of(const MeshSpec& spec) {
  return fmt::format("{} {} {} {} {} {} {} {}", spec.generator, spec.size_m.x(), spec.size_m.y(),
                     spec.size_m.z(), spec.radius_m, spec.length_m, spec.element_size_m, spec.grading);
}

/// Reads the tetrahedra of any file, with their regions, or a whole model; or generates them.
store::ModelFile read(const MeshSpec& spec, const fs::path& path, const std::string& scene_folder) {
  store::ModelFile out;
  if (path.extension() == ".h5") {
    if (store::is_model(path.string())) return store::read_model(path.string());
    out.model.tets = store::read_mesh(path.string());
  } else {
    MeshSpec unscaled = spec;
    unscaled.scale = 1.0;  // The scene's scale applies to the copy.
    out.model.tets = mesh::tet_mesh(unscaled, scene_folder, nullptr, &out.model.regions);
  }
  return out;
}

void refine_tets(store::ModelFile& file) {
  LayeredModel& model = file.model;
  mesh::RefinedTets fine = mesh::refine(model.tets);
  model.tets = std::move(fine.mesh);
  file.edges.insert(file.edges.end(), fine.edges.begin(), fine.edges.end());
  std::vector<int>& bones = model.bone_of_node;
  if (!bones.empty())
    for (const auto& [a, b] : fine.edges) {
      const int bone = bones[static_cast<std::size_t>(a)];
      bones.push_back(bone == bones[static_cast<std::size_t>(b)] ? bone : -1);
    }
  for (MaterialRegion& region : model.regions) {
    std::vector<int> children;
    children.reserve(kChildren * region.tets.size());
    for (const int tet : region.tets)
      for (int child = 0; child < kChildren; ++child) children.push_back(kChildren * tet + child);
    region.tets = std::move(children);
  }
}

}  // namespace

void RefinedMeshes::make_shape(const std::string& name, const std::string& from, int tets, int skin,
                               const std::string& out) const {
  const LayeredModel own = store::read_model(from).model;
  make_model_(name, std::lround(std::ldexp(static_cast<double>(own.tets.tets.cols()), 3 * tets)),
              std::lround(std::ldexp(static_cast<double>(own.skin.vertices.cols()), 2 * skin)), out);
}

std::string RefinedMeshes::path(const MeshSpec& spec, const std::string& scene_folder, int tets, int skin) {
  const bool generated = spec.file.empty();
  const fs::path source =
      generated ? fs::path(spec.generator) : fs::absolute(fs::path(scene_folder) / spec.file);
  const std::string name =
      fmt::format("{}-tets-{}-skin-{}", generated ? text_of(spec) : source.string(), tets, skin);
  if (const auto found = made_.find(name); found != made_.end()) return found->second;

  std::error_code failed;
  fs::create_directories(folder_, failed);
  if (failed) fail("{}: the folder of refined meshes cannot be created: {}", folder_, failed.message());
  const fs::path out = fs::absolute(fs::path(folder_) / fmt::format("{}-{}-tets-{}-skin-{}.h5", made_.size(),
                                                                    source.stem().string(), tets, skin));
  if (const std::string shape = store::name_of_cached(source.string());
      make_model_ && tets != 0 && !shape.empty()) {
    make_shape(shape, source.string(), tets, skin, out.string());
    return made_[name] = out.string();
  }
  if (tets < 0 || skin < 0)
    fail("{}: {} has no coarser level; --coarser 0 omits it{}", source.filename().string(),
         generated ? "a curved body with attachments" : "a mesh from a file",
         generated ? ", and a larger element_size_m begins there" : "");
  store::ModelFile file = read(spec, source, scene_folder);
  if (skin > 0) file.model.proxies.clear();  // They list the vertices of the coarse skin.
  mesh::Provenance from;
  from.source = source.string();
  mesh::check_tets(file.model.tets, from);
  for (int i = 0; i < tets; ++i) refine_tets(file);
  for (int i = 0; i < skin; ++i) file.model.skin = mesh::refine(file.model.skin);
  if (file.model.skin.vertices.cols() > 0)
    file.model.embedding = mesh::embed(file.model.tets, file.model.skin.vertices);
  file.record.source = source.filename().string();
  file.record.options = fmt::format("refined: tetrahedra {} times, skin {} times", tets, skin);
  file.record.version = store::version();
  store::write_model(out.string(), file);
  return made_[name] = out.string();
}

}  // namespace palpate::compare
