#include "recorded_surfaces.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/object_colours.h"
#include "palpate/core/error.h"
#include "recorded_scene.h"
#include "render/colour_map.h"
#include "store/part_surface.h"

namespace palpate::cli {
namespace {

store::Rgb8 bytes_of(const render::Rgb& c) {
  const auto byte = [](float channel) { return static_cast<std::uint8_t>(std::lround(255.0f * channel)); };
  return {byte(c.r), byte(c.g), byte(c.b)};
}

std::unique_ptr<loop::World> assembled(const store::RunReader& run, const std::string& run_file) {
  try {
    return loop::assemble(
        recorded_scene(run.info().scene_source, std::filesystem::path(run_file).parent_path()));
  } catch (const Error& e) {
    fail("{}; use --no-skin to export the surfaces of the tetrahedra, which require only {}", e.what(),
         run_file);
  }
}

}  // namespace

RecordedSurfaces::RecordedSurfaces(const store::RunReader& run, const std::string& run_file,
                                   const std::vector<int>& parts, bool skins)
    : run_(run) {
  if (skins) world_ = assembled(run, run_file);
  for (const int part : parts) {
    const store::RunPart& p = run.parts()[static_cast<std::size_t>(part)];
    const loop::Body* body = world_ && p.tets.cols() > 0 ? world_->find_body(p.name) : nullptr;
    if (world_ && p.tets.cols() > 0 && (!body || body->placed.cols() != p.reference.cols()))
      fail(
          "{}: body \"{}\" has {} nodes, but its scene now has {}: the mesh has changed since the run; use "
          "--no-skin to export the recorded surface of the tetrahedra",
          run_file, p.name, p.reference.cols(),
          body ? fmt::format("{} nodes", body->placed.cols()) : "no such body");
    add(part, body);
  }
}

void RecordedSurfaces::add(int part, const loop::Body* body) {
  const store::RunPart& p = run_.parts()[static_cast<std::size_t>(part)];
  Surface s;
  s.part = part;
  s.rigid = p.tets.cols() == 0;
  if (body && body->skin) {
    s.faces = body->surface_faces();
    // the file stores the nodes in the order of the mesh file
    s.points = [body](const Points& nodes) {
      return body->surface_points(nodes(Eigen::all, body->file_node));
    };
    s.values = [body](const VecX& nodes) { return body->surface_values(nodes(body->file_node)); };
  } else {
    store::PartSurface shown = store::part_surface(p);
    s.faces = std::move(shown.faces);
    const auto node = std::make_shared<std::vector<int>>(std::move(shown.node_of_vertex));
    s.points = [node](const Points& nodes) -> Points { return nodes(Eigen::all, *node); };
    s.values = [node](const VecX& nodes) -> VecX { return nodes(*node); };
  }
  if (s.faces.cols() == 0) return;  // no visible surface
  s.rest = s.points(p.reference);
  surfaces_.push_back(std::move(s));
}

store::Rgb8 RecordedSurfaces::colour(std::size_t i) const {
  return bytes_of(render::colour_of(rigid(i) ? colours::tool(0) : colours::kBody));
}

double RecordedSurfaces::largest_displacement(const std::vector<int>& steps) const {
  constexpr double kRounding = 1e-9;  // less than this share is rounding
  double largest = 0.0, size = 0.0;
  for (const Surface& s : surfaces_)
    size = std::max(size, (s.rest.rowwise().maxCoeff() - s.rest.rowwise().minCoeff()).norm());
  for (const int step : steps) {
    const Points moved = run_.displacement(step);
    for (const Surface& s : surfaces_)
      if (!s.rigid)
        largest =
            std::max(largest, moved
                                  .middleCols(run_.first_point(s.part),
                                              run_.parts()[static_cast<std::size_t>(s.part)].reference.cols())
                                  .colwise()
                                  .norm()
                                  .maxCoeff());
  }
  return largest > kRounding * size ? largest : 0.0;
}

std::vector<store::SurfaceState> RecordedSurfaces::at(int step, double largest) const {
  const Points points = run_.points(step);
  const VecX stress = run_.stress(step);
  std::vector<store::SurfaceState> out;
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    const Surface& s = surfaces_[i];
    const store::RunPart& part = run_.parts()[static_cast<std::size_t>(s.part)];
    const Eigen::Index first = run_.first_point(s.part), n = part.reference.cols();
    store::SurfaceState state{part.name, s.points(points.middleCols(first, n)), s.faces, {}, {}, {}};
    state.displacement = (state.points - s.rest).colwise().norm().transpose();
    state.stress = s.values(stress.segment(first, n));
    for (const double moved : state.displacement)
      state.colours.push_back(s.rigid ? colour(i)
                                      : bytes_of(render::ramp(largest > 0.0 ? moved / largest : 0.0)));
    out.push_back(std::move(state));
  }
  return out;
}

}  // namespace palpate::cli
