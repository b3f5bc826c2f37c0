#include "model/make_model.h"

#include <algorithm>
#include <filesystem>

#include "core/clock.h"
#include "mesh/surface_checks.h"
#include "mesh/tet_checks.h"
#include "model/bind.h"
#include "model/creases.h"
#include "palpate/core/error.h"
#include "palpate/mesh/boundary.h"
#include "palpate/mesh/embedding.h"
#include "palpate/mesh/quality.h"
#include "proxy/decompose.h"
#include "store/content_hash.h"
#include "store/provenance.h"

namespace palpate::model {
namespace {

/// Runs named steps, records their times, and starts none when the time is over.
class Steps {
 public:
  Steps(ProgressListener& watcher, Made& made, const std::string& source, double limit)
      : watcher_(watcher), made_(made), source_(source), limit_(limit) {}

  template <class Work>
  void operator()(const char* name, Work work) {
    if (left() <= 0)
      fail("{}: the time limit of {:.3g} s ended before \"{}\"; raise it with --limit-s", source_, limit_,
           name);
    watcher_.begin(name);
    const double start = wall_seconds();
    work();
    made_.steps.push_back({name, wall_seconds() - start});
    watcher_.end(made_.steps.back());
  }
  double spent() const { return wall_seconds() - start_; }
  double left() const { return limit_ - spent(); }

 private:
  ProgressListener& watcher_;
  Made& made_;
  const std::string& source_;
  double limit_, start_ = wall_seconds();
};

/// Scales and rotates all coordinates.
void transform(Input& input, double by, const Quat& rotation) {
  if (!(by > 0 && std::isfinite(by))) fail("--scale {} must be positive; it multiplies the coordinates", by);
  const Mat3 of_axes = by * rotation.toRotationMatrix();
  for (Points* points : {&input.surface.vertices, &input.tets.nodes, &input.skin.vertices})
    *points = of_axes * *points;
  for (Polyline& line : input.creases)
    for (Vec3& p : line) p = of_axes * p;
  for (Bone& bone : input.skeleton.bones) {
    bone.head = of_axes * bone.head;
    bone.tail = of_axes * bone.tail;
    bone.head_radius *= by;
    bone.tail_radius *= by;
  }
}

TriMesh mended(Input& input, const Options& options, std::vector<std::string>& notes,
               const Progress& progress, ProgressListener& watcher) {
  if (input.sound) {
    mesh::check_surface(input.surface, input.from);
    mesh::Provenance skin;
    skin.source = "skin of " + input.source;
    if (input.skin.vertices.cols() > 0) mesh::check_surface(input.skin, skin);
    return input.surface;
  }
  RepairOptions requested = options.repair;
  requested.place = [&](const std::string& where) { watcher.place(where); };
  RepairedSurface repaired = repair(input.surface, input.from, requested, progress);
  notes.insert(notes.end(), repaired.notes.begin(), repaired.notes.end());
  return std::move(repaired.surface);
}

/// Takes a user's tetrahedra: they must be sound, or are rejected.  Returns their boundary, mended like any
/// other surface if it is to be filled anew.
TriMesh take_tets(Input& input, const Options& options, std::vector<std::string>& notes,
                  const Progress& progress, ProgressListener& watcher) {
  const mesh::MeshReport report = mesh::check_tets(input.tets, input.from);
  if (report.flipped > 0)
    notes.push_back(fmt::format("{} inverted tetrahedra were reoriented", report.flipped));
  if (!options.remesh) {
    check_sides(input.tets, input.source);
    return mesh::boundary(input.tets).surface;
  }
  Input outside;
  outside.surface = mesh::boundary(input.tets).surface;
  outside.from = mesh::surface_provenance(input.from.source + ": boundary");
  return mended(outside, options, notes, progress, watcher);
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

/// Adds the regions of the file and the requested ones, with their volumes.
void find_regions(Input& input, const Options& options, const TetMesh* old, Made& made) {
  LayeredModel& model = made.file.model;
  std::vector<MaterialRegion> regions =
      old ? carried_over(*old, input.regions, model.tets) : std::move(input.regions);
  if (old && !regions.empty())
    made.file.record.notes.emplace_back(
        "the regions of the file were transferred to the new tetrahedra by centroid");
  std::vector<RegionSource> sources = options.regions;
  for (RegionSource& source : sources)
    source.surface.vertices = options.scale * options.rotation.toRotationMatrix() * source.surface.vertices;
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
  mesh::Provenance place = out.from;
  place.source = out.source;  // the record must not contain a folder of this machine
  for (const auto& text :
       {mesh::warped_text(file.polygons, place), mesh::crossing_text(file.polygons, place)})
    if (!text.empty()) out.notes.push_back(text);
  return out;
}

namespace {

/// Surface to fill, with its input and options.
struct Filling {
  const TriMesh& surface;
  const Input& input;
  const Options& options;
};

QualityGate gate_of(const Options& options, bool creased, bool given) {
  QualityGate out;
  out.smallest_dihedral_deg =
      options.smallest_dihedral_deg.value_or(creased ? kSharpDihedralDeg : out.smallest_dihedral_deg);
  out.given = given;
  return out;
}

Tetrahedra filled(const Filling& filling, std::optional<double> crease_deg, double spent,
                  const Progress& progress) {
  TetrahedraOptions requested = filling.options.tetrahedra;
  requested.limits.spent = spent;
  requested.crease_deg = crease_deg;
  if (filling.options.creases != Creases::kNone) requested.creases = filling.input.creases;
  Tetrahedra out = tetrahedralise(filling.surface, requested, progress);
  const TetQuality quality = measure_quality(out.mesh, mesh::enclosed_volume(filling.surface));
  pass_gate(out.mesh, quality, gate_of(filling.options, crease_deg || !requested.creases.empty(), false),
            filling.input.source, filling.surface);
  return out;
}

/// Fills the surface; automatically detected creases are dropped if they cannot be kept.
TetMesh fill(const Filling& filling, const Steps& steps, const Progress& progress, Made& made) {
  std::vector<std::string>& notes = made.file.record.notes;
  const bool automatic = filling.options.creases == Creases::kAuto;
  const std::optional<double> crease_deg = crease_angle_of(filling.surface, filling.input, filling.options);
  const bool lines = filling.options.creases != Creases::kNone && !filling.input.creases.empty();
  made.creased = crease_deg || lines;
  Tetrahedra out;
  try {
    out = filled(filling, crease_deg, steps.spent(), progress);
    if (crease_deg && automatic)
      notes.push_back(
          fmt::format("edges that turn by more than {:g} degrees are kept as creases", *crease_deg));
  } catch (const Error& e) {
    if (!crease_deg || !automatic || steps.left() <= 0) throw;
    made.creased = lines;
    out = filled(filling, std::nullopt, steps.spent(), progress);
    notes.push_back(
        fmt::format("edges that turn by more than {:g} degrees could not be kept as creases ({}); "
                    "they are rounded by half an element",
                    *crease_deg, e.what()));
  }
  notes.insert(notes.end(), out.notes.begin(), out.notes.end());
  return std::move(out.mesh);
}

/// Embeds the skin.
/// @throws Error with a remedy if the tetrahedra are too coarse for the skin
mesh::Embedding embedded(const LayeredModel& model, const std::string& source,
                         mesh::EmbeddingReport& report) {
  try {
    return mesh::embed(model.tets, model.skin.vertices, &report);
  } catch (const Error& e) { fail("{}: {}; increase --tetrahedra", source, e.what()); }
}

/// Measures the quality of the tetrahedra, and refuses those that cannot be simulated.
/// @param as_given  whether the tetrahedra are the input's
void check_quality(const Input& input, const Options& options, bool as_given, const TriMesh& surface,
                   Made& made) {
  TetMesh& tets = made.file.model.tets;
  made.quality = measure_quality(tets, mesh::enclosed_volume(surface));
  QualityGate gate = gate_of(options, made.creased, as_given);
  if (as_given && options.accept_angles && made.quality.smallest_dihedral_deg < gate.smallest_dihedral_deg) {
    made.angle_cost = price_of_angles(tets, gate.smallest_dihedral_deg);
    gate.smallest_dihedral_deg = 0.0;
    made.file.record.notes.push_back(text(*made.angle_cost));
  }
  pass_gate(tets, made.quality, gate, input.source, surface);
  mesh::Provenance own;
  own.source = "tetrahedra of " + input.source;
  mesh::check_tets(tets, own);
}

}  // namespace

Made make_model(Input input, const Options& given_options, ProgressListener& watcher) {
  Options options = given_options;
  options.tetrahedra.stage = [&](const std::string& stage) { watcher.stage(stage); };
  options.tetrahedra.place = [&](const Vec3& at) { watcher.point(at); };
  Made made;
  LayeredModel& model = made.file.model;
  store::ModelRecord& record = made.file.record;
  const Progress progress = [&](double fraction) { watcher.progress(fraction); };
  record.source = input.source;
  record.source_hash = input.source_hash;
  record.version = store::provenance().version;
  record.notes = std::move(input.notes);
  model.name = input.name;
  transform(input, options.scale, options.rotation);
  Steps step(watcher, made, record.source, options.tetrahedra.limits.seconds);

  TriMesh surface;
  const bool given = input.tets.tets.cols() > 0;
  step(given ? "check the tetrahedra" : "repair the surface", [&] {
    surface = given ? take_tets(input, options, record.notes, progress, watcher)
                    : mended(input, options, record.notes, progress, watcher);
  });

  const TetMesh old = given && options.remesh && !input.regions.empty() ? input.tets : TetMesh{};
  const bool as_given = given && !options.remesh;
  if (as_given) {
    model.tets = std::move(input.tets);
  } else {
    step("fill with tetrahedra", [&] { model.tets = fill({surface, input, options}, step, progress, made); });
  }
  step("check the quality", [&] { check_quality(input, options, as_given, surface, made); });

  model.skeleton = std::move(input.skeleton);
  if (!input.regions.empty() || !options.regions.empty())
    step("name regions", [&] { find_regions(input, options, old.tets.cols() > 0 ? &old : nullptr, made); });
  mesh::EmbeddingReport embedding;
  step("embed the skin", [&] {
    model.skin = input.skin.vertices.cols() > 0 ? std::move(input.skin) : std::move(surface);
    model.embedding = embedded(model, input.source, embedding);
  });
  if (!model.skeleton.bones.empty())
    step("bind the skeleton",
         [&] { model.bone_of_node = bind_nodes(model.tets.nodes, model.skeleton, options.bone_margin_m); });
  proxy::DecomposeReport hulls;
  if (options.proxies > 0)
    step("cut into convex proxies", [&] {
      proxy::DecomposeOptions requested;
      requested.count = options.proxies;
      model.proxies = proxy::decompose(model, requested, &hulls);
    });
  record.figures = figures(model, made.quality, embedding, hulls);
  if (made.angle_cost) {
    record.figures.emplace_back("explicit_step_s", made.angle_cost->explicit_step_s);
    record.figures.emplace_back("condition_number", made.angle_cost->condition);
  }
  for (const RegionFigures& region : made.regions)
    record.figures.emplace_back(fmt::format("volume_of_region_{}_m3", region.name), region.volume);
  return made;
}

}  // namespace palpate::model
