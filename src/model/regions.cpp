#include "model/regions.h"

#include <algorithm>

#include "model/bind.h"
#include "model/repair.h"
#include "palpate/core/error.h"
#include "palpate/mesh/boundary.h"
#include "palpate/mesh/embedding.h"

namespace palpate::model {
namespace {

Points middles(const TetMesh& mesh) {
  Points out = Points::Zero(3, mesh.tets.cols());
  for (Eigen::Index t = 0; t < mesh.tets.cols(); ++t)
    for (int k = 0; k < 4; ++k) out.col(t) += 0.25 * mesh.nodes.col(mesh.tets(k, t));
  return out;
}

std::vector<char> inside_bones(const Skeleton& skeleton, const Points& points) {
  std::vector<char> out;
  for (const auto& p : points.colwise())
    out.push_back(std::any_of(skeleton.bones.begin(), skeleton.bones.end(),
                              [&](const Bone& bone) { return distance_to_bone(bone, p) <= 0.0; }));
  return out;
}

std::string box_of(const Points& points) {
  const Vec3 low = points.rowwise().minCoeff(), high = points.rowwise().maxCoeff();
  return fmt::format("({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g}) m", low.x(), low.y(), low.z(),
                     high.x(), high.y(), high.z());
}

std::vector<char> inside(const RegionSource& source, const TetMesh& tets, const Points& points,
                         const Skeleton& skeleton, double& volume) {
  if (source.skeleton) {
    if (skeleton.bones.empty())
      fail("--region {}=skeleton: the model has no bones; of the shapes, human has bones", source.name);
    std::vector<char> out = inside_bones(skeleton, points);
    if (std::find(out.begin(), out.end(), 1) == out.end())
      fail("--region {}=skeleton: no tetrahedron has its centroid in a bone; increase --tetrahedra",
           source.name);
    return out;
  }
  const TriMesh surface = repair(source.surface, source.from).surface;
  volume = mesh::enclosed_volume(surface);
  std::vector<char> out = inside_of(surface, points);
  if (std::find(out.begin(), out.end(), 1) == out.end())
    fail(
        "--region {}={}: no tetrahedron has its centroid inside: the surface extends from {}, the tetrahedra "
        "from {}; --scale applies to both, and a thin surface needs more tetrahedra",
        source.name, source.from.source, box_of(surface.vertices), box_of(tets.nodes));
  return out;
}

}  // namespace

std::vector<MaterialRegion> add_regions(const TetMesh& tets, const Skeleton& skeleton,
                                        std::vector<MaterialRegion> regions,
                                        const std::vector<RegionSource>& sources,
                                        std::vector<double>& surface_volumes) {
  const Points points = middles(tets);
  surface_volumes.assign(sources.size(), 0.0);
  for (std::size_t s = 0; s < sources.size(); ++s) {
    const std::string& name = sources[s].name;
    if (std::any_of(regions.begin(), regions.end(), [&](const MaterialRegion& r) { return r.name == name; }))
      fail("--region {}=...: there is already a region of this name; choose another", name);
    const std::vector<char> in = inside(sources[s], tets, points, skeleton, surface_volumes[s]);
    for (MaterialRegion& region : regions)
      std::erase_if(region.tets, [&](int tet) { return in[static_cast<std::size_t>(tet)] != 0; });
    regions.push_back({name, {}});
    for (std::size_t t = 0; t < in.size(); ++t)
      if (in[t]) regions.back().tets.push_back(static_cast<int>(t));
  }
  std::erase_if(regions, [](const MaterialRegion& r) { return r.tets.empty(); });
  return regions;
}

std::vector<MaterialRegion> carried_over(const TetMesh& old, const std::vector<MaterialRegion>& regions,
                                         const TetMesh& tets) {
  if (regions.empty()) return {};
  const std::vector<int> held_by = mesh::embed(old, middles(tets)).tet;
  std::vector<MaterialRegion> out = regions;
  for (MaterialRegion& region : out) {
    std::vector<char> held(static_cast<std::size_t>(old.tets.cols()), 0);
    for (const int tet : region.tets) held[static_cast<std::size_t>(tet)] = 1;
    region.tets.clear();
    for (std::size_t t = 0; t < held_by.size(); ++t)
      if (held[static_cast<std::size_t>(held_by[t])]) region.tets.push_back(static_cast<int>(t));
  }
  std::erase_if(out, [](const MaterialRegion& r) { return r.tets.empty(); });
  return out;
}

}  // namespace palpate::model
