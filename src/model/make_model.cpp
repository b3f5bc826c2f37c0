#include "palpate/model/make_model.h"

#include <algorithm>
#include <filesystem>

#include "palpate/core/clock.h"
#include "palpate/core/error.h"
#include "palpate/mesh/boundary.h"
#include "palpate/mesh/embedding.h"
#include "palpate/mesh/quality.h"
#include "palpate/model/bind.h"
#include "palpate/model/creases.h"
#include "palpate/proxy/decompose.h"
#include "palpate/store/content_hash.h"
#include "palpate/store/provenance.h"

namespace palpate::model {
namespace {

/// Runs a step under its name, and keeps how long it took.
template <class Work>
void step(const char* name, Watcher& watcher, Made& made, Work work) {
  watcher.begin(name);
  const double start = wall_seconds();
  work();
  made.steps.push_back({name, wall_seconds() - start});
  watcher.end(made.steps.back());
}

void scale(Input& input, double by) {
  if (!(by > 0 && std::isfinite(by))) fail("--scale {} must be positive; it multiplies the coordinates", by);
  input.surface.vertices *= by;
  input.tets.nodes *= by;
  input.skin.vertices *= by;
  for (Polyline& line : input.creases)
    for (Vec3& p : line) p *= by;
  for (Bone& bone : input.skeleton.bones) {
    bone.head *= by;
    bone.tail *= by;
    bone.head_radius *= by;
    bone.tail_radius *= by;
  }
}

/// Tetrahedra that a person brought: sound as they are, or refused.  Returns the boundary.
TriMesh take_tets(Input& input, std::vector<std::string>& notes) {
  const mesh::MeshReport report = mesh::check_tets(input.tets, input.from);
  if (report.flipped > 0) notes.push_back(fmt::format("{} tetrahedra were turned round", report.flipped));
  return mesh::boundary(input.tets).surface;
}

TriMesh mended(Input& input, const Options& options, std::vector<std::string>& notes,
               const Progress& progress) {
  if (input.sound) {
    mesh::check_surface(input.surface, input.from);
    return input.surface;
  }
  RepairedSurface repaired = repair(input.surface, input.from, options.repair, progress);
  notes.insert(notes.end(), repaired.notes.begin(), repaired.notes.end());
  return std::move(repaired.surface);
}

std::optional<double> crease_angle_of(const TriMesh& surface, const Input& input, const Options& options) {
  if (options.creases == Creases::kAngle) {
    if (!(options.crease_deg > 0 && options.crease_deg < 180))
      fail("--creases {} must lie between 0 and 180 degrees", options.crease_deg);
    return options.crease_deg;
  }
  if (options.creases == Creases::kNone || !input.creases.empty()) return std::nullopt;
  return crease_angle(surface);
}

/// Regions of the file and those asked for, with what they hold.
void find_regions(Input& input, const Options& options, const TetMesh* old, Made& made) {
  LayeredModel& model = made.file.model;
  std::vector<MaterialRegion> regions =
      old ? carried_over(*old, input.regions, model.tets) : std::move(input.regions);
  if (old && !regions.empty())
    made.file.record.notes.push_back(
        "the regions of the file are carried over to the new tetrahedra by their middles");
  std::vector<RegionSource> sources = options.regions;
  for (RegionSource& source : sources) source.surface.vertices *= options.scale;
  std::vector<double> surface_volumes;
  model.regions = add_regions(model.tets, model.skeleton, std::move(regions), sources, surface_volumes);
  for (const MaterialRegion& region : model.regions) {
    RegionFigures& out =
        made.regions.emplace_back(RegionFigures{region.name, static_cast<int>(region.tets.size())});
    for (const int tet : region.tets) out.volume += mesh::tet_volume(model.tets, tet);
    for (std::size_t s = 0; s < sources.size(); ++s)
      if (sources[s].name == region.name) out.surface_volume = surface_volumes[s];
  }
}

std::vector<std::pair<std::string, double>> figures(const LayeredModel& model, const TetQuality& q,
                                                    const mesh::EmbeddingReport& embedding,
                                                    const proxy::DecomposeReport& hulls) {
  std::vector<std::pair<std::string, double>> out = {
      {"nodes", q.nodes},
      {"tetrahedra", q.tetrahedra},
      {"skin_vertices", static_cast<double>(model.skin.vertices.cols())},
      {"skin_faces", static_cast<double>(model.skin.faces.cols())},
      {"smallest_dihedral_deg", q.smallest_dihedral_deg},
      {"largest_dihedral_deg", q.largest_dihedral_deg},
      {"worst_aspect_ratio", q.worst_aspect},
      {"mean_edge_m", q.mean_edge},
      {"volume_m3", q.volume},
      {"surface_volume_m3", q.surface_volume},
      {"volume_error", q.volume_error},
      {"skin_vertices_outside", embedding.outside},
      {"farthest_outside_m", embedding.largest_distance},
      {"largest_weight_sum", embedding.largest_weight_sum}};
  if (!model.proxies.empty()) {
    out.emplace_back("proxies", static_cast<double>(model.proxies.size()));
    out.emplace_back("skin_outside_its_hull_m", hulls.largest_outside);
    out.emplace_back("hull_beyond_its_skin_m", hulls.largest_gap);
  }
  if (!model.skeleton.bones.empty()) {
    out.emplace_back("bones", static_cast<double>(model.skeleton.bones.size()));
    out.emplace_back("nodes_on_bones",
                     static_cast<double>(model.bone_of_node.size() -
                                         static_cast<std::size_t>(std::count(model.bone_of_node.begin(),
                                                                             model.bone_of_node.end(), -1))));
  }
  return out;
}

}  // namespace

Input input_of_file(const std::string& path) {
  SourceFile file = read_source(path);
  Input out;
  out.name = std::filesystem::path(path).stem().string();
  out.source = std::filesystem::path(path).filename().string();
  store::ContentHash hash;
  out.source_hash = hash.add_file(path).hex();
  out.format = std::move(file.format);
  out.from = std::move(file.from);
  out.surface = std::move(file.surface);
  out.tets = std::move(file.tets);
  out.regions = std::move(file.regions);
  return out;
}

Made make_model(Input input, const Options& options, Watcher& watcher) {
  Made made;
  LayeredModel& model = made.file.model;
  store::ModelRecord& record = made.file.record;
  const Progress progress = [&](double fraction) { watcher.progress(fraction); };
  record.source = input.source;
  record.source_hash = input.source_hash;
  record.version = store::provenance().version;
  model.name = input.name;
  scale(input, options.scale);

  TriMesh surface;
  const bool given = input.tets.tets.cols() > 0;
  step(given ? "check the tetrahedra" : "mend the surface", watcher, made, [&] {
    surface = given ? take_tets(input, record.notes) : mended(input, options, record.notes, progress);
  });

  const TetMesh old = given && options.remesh && !input.regions.empty() ? input.tets : TetMesh{};
  if (given && !options.remesh) {
    model.tets = std::move(input.tets);
  } else {
    step("fill with tetrahedra", watcher, made, [&] {
      TetrahedraOptions wanted = options.tetrahedra;
      wanted.crease_deg = crease_angle_of(surface, input, options);
      wanted.creases = options.creases == Creases::kNone ? std::vector<Polyline>{} : input.creases;
      made.creased = wanted.crease_deg || !wanted.creases.empty();
      if (wanted.crease_deg && options.creases == Creases::kAuto)
        record.notes.push_back(
            fmt::format("edges that turn by more than {:g} degrees are kept as creases", *wanted.crease_deg));
      model.tets = tetrahedralise(surface, wanted, progress).mesh;
    });
  }
  step("check the quality", watcher, made, [&] {
    made.quality = measure_quality(model.tets, mesh::enclosed_volume(surface));
    QualityGate gate;
    gate.smallest_dihedral_deg =
        options.smallest_dihedral_deg.value_or(made.creased ? kSharpDihedralDeg : gate.smallest_dihedral_deg);
    pass_gate(model.tets, made.quality, gate, input.source);
    mesh::Provenance own;
    own.source = "tetrahedra of " + input.source;
    mesh::check_tets(model.tets, own);
  });

  model.skeleton = std::move(input.skeleton);
  if (!input.regions.empty() || !options.regions.empty())
    step("name regions", watcher, made,
         [&] { find_regions(input, options, old.tets.cols() > 0 ? &old : nullptr, made); });
  mesh::EmbeddingReport embedding;
  step("embed the skin", watcher, made, [&] {
    model.skin = input.skin.vertices.cols() > 0 ? std::move(input.skin) : std::move(surface);
    model.embedding = mesh::embed(model.tets, model.skin.vertices, &embedding);
  });
  if (!model.skeleton.bones.empty())
    step("bind the skeleton", watcher, made,
         [&] { model.bone_of_node = bind_nodes(model.tets.nodes, model.skeleton, options.bone_margin_m); });
  proxy::DecomposeReport hulls;
  if (options.proxies > 0)
    step("cut into convex proxies", watcher, made, [&] {
      proxy::DecomposeOptions wanted;
      wanted.count = options.proxies;
      model.proxies = proxy::decompose(model, wanted, &hulls);
    });
  record.figures = figures(model, made.quality, embedding, hulls);
  for (const RegionFigures& region : made.regions)
    record.figures.emplace_back(fmt::format("volume_of_region_{}_m3", region.name), region.volume);
  return made;
}

}  // namespace palpate::model
