#include <algorithm>

#include "assemble_parts.h"
#include "core/counters.h"
#include "palpate/core/error.h"
#include "palpate/core/log.h"
#include "palpate/core/named_enum.h"
#include "palpate/fem/attachments.h"
#include "palpate/mesh/quality.h"

namespace palpate::loop {
namespace {

/// Returns the material of the body.
fem::Material material_of(const SoftBodySpec& spec) {
  return {spec.youngs_modulus_pa, spec.poissons_ratio, spec.density_kg_m3, spec.mass_damping_per_s,
          spec.stiffness_damping_s};
}

std::vector<std::string> names_of(const std::vector<Region>& regions) {
  std::vector<std::string> out;
  for (const Region& region : regions) out.push_back(region.name);
  return out;
}

/// Returns the elements whose centroid lies in the box or the sphere.
std::vector<int> elements_in(const RegionSpec& spec, const Points& placed, const Tets& tets) {
  Points centroids(3, tets.cols());
  for (Eigen::Index t = 0; t < tets.cols(); ++t)
    centroids.col(t) = placed(Eigen::all, tets.col(t)).rowwise().mean();
  return spec.region == Selection::kBox ? fem::nodes_in_box(centroids, spec.box_min_m, spec.box_max_m)
                                        : fem::nodes_in_sphere(centroids, spec.centre_m, spec.radius_m);
}

/// Returns the region for a table of the scene: one of the file, or a new one.
Region& region_for(const SoftBodySpec& spec, const RegionSpec& requested, std::vector<Region>& regions,
                   const Body& body) {
  const auto found =
      std::find_if(regions.begin(), regions.end(), [&](const Region& r) { return r.name == requested.name; });
  if (requested.region == Selection::kFile) {
    if (found != regions.end()) return *found;
    if (regions.empty())
      fail(
          "body \"{}\": [[body.region]] \"{}\": {} has no regions; create them with `palpate model "
          "--region`, or select elements by box_min_m and box_max_m, or by centre_m and radius_m",
          spec.name, requested.name, spec.mesh.file);
    fail("body \"{}\": {} has no region \"{}\"{}", spec.name, spec.mesh.file, requested.name,
         suggestion(requested.name, names_of(regions)));
  }
  if (found != regions.end())
    fail("body \"{}\": region \"{}\" also exists in {}; give the {} another name", spec.name, requested.name,
         spec.mesh.file, name_of(requested.region));
  regions.push_back({requested.name, elements_in(requested, body.placed, body.rest.tets)});
  return regions.back();
}

/// Returns the material of a region: values set in the scene, else those of `base`, which is the body's
/// material times the factors of a model file.
fem::Material material_of(const RegionSpec& requested, const fem::Material& base) {
  fem::Material out = base;
  if (requested.youngs_modulus_pa) out.youngs_modulus = *requested.youngs_modulus_pa;
  if (requested.poissons_ratio) out.poissons_ratio = *requested.poissons_ratio;
  if (requested.density_kg_m3) out.density = *requested.density_kg_m3;
  if (requested.mass_damping_per_s) out.mass_damping = *requested.mass_damping_per_s;
  if (requested.stiffness_damping_s) out.stiffness_damping = *requested.stiffness_damping_s;
  return out;
}

/// Assigns each element to the last of its regions with a material, else to its smallest region in the file.
void settle(Body& body) {
  std::vector<int> owner(static_cast<std::size_t>(body.rest.tets.cols()), -1);
  std::vector<std::size_t> order(body.regions.size());
  for (std::size_t r = 0; r < order.size(); ++r) order[r] = r;
  const auto rank = [&](std::size_t r) {
    return std::pair(body.regions[r].material, -static_cast<long>(body.regions[r].tets.size()));
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });
  for (const std::size_t r : order)
    for (const int tet : body.regions[r].tets) owner[static_cast<std::size_t>(tet)] = static_cast<int>(r);
  for (std::size_t r = 0; r < body.regions.size(); ++r)
    std::erase_if(body.regions[r].tets,
                  [&](int tet) { return owner[static_cast<std::size_t>(tet)] != static_cast<int>(r); });
}

}  // namespace

fem::Materials assemble_materials(const SoftBodySpec& spec, std::vector<MaterialRegion> in_file, Body& body) {
  fem::Materials out(material_of(spec));
  const std::string where = fmt::format("body \"{}\"", spec.name);
  fem::check(out.list[0], where.c_str());
  std::vector<fem::Material> bases;  // one per region of the file
  for (MaterialRegion& region : in_file) {
    const bool named = std::any_of(spec.regions.begin(), spec.regions.end(),
                                   [&](const RegionSpec& r) { return r.name == region.name; });
    body.regions.push_back({region.name, std::move(region.tets), 0, 0.0, region.youngs_modulus_factor});
    fem::Material& base = bases.emplace_back(out.list[0]);
    base.youngs_modulus *= region.youngs_modulus_factor;
    base.density *= region.density_factor;
    if (named) continue;
    if (region.youngs_modulus_factor != 1.0 || region.density_factor != 1.0) {
      body.regions.back().material = static_cast<int>(out.list.size());
      out.list.push_back(base);
    }
  }
  for (const RegionSpec& requested : spec.regions) {
    Region& region = region_for(spec, requested, body.regions, body);
    const auto number = static_cast<std::size_t>(&region - body.regions.data());
    region.material = static_cast<int>(out.list.size());
    region.own_stiffness = requested.youngs_modulus_pa.has_value();
    out.list.push_back(material_of(requested, number < bases.size() ? bases[number] : out.list[0]));
    fem::check(out.list.back(), fmt::format("{}: region \"{}\"", where, region.name).c_str());
  }
  if (body.regions.empty()) return out;
  settle(body);
  std::erase_if(body.regions, [](const Region& r) { return r.tets.empty() && r.material == 0; });
  std::vector<std::string> unnamed;
  for (const Region& region : body.regions)
    if (region.material == 0 && static_cast<Eigen::Index>(region.tets.size()) < body.rest.tets.cols())
      unnamed.push_back(region.name);
  if (!unnamed.empty())
    log::info("body \"{}\": the scene does not list {}, so the material of the body applies: {} of {}",
              spec.name, unnamed.size() == 1 ? "it" : "them", fmt::join(unnamed, ", "), spec.mesh.file);
  for (Region& region : body.regions)
    for (const int tet : region.tets) region.volume += mesh::tet_volume(body.rest, tet);
  for (const Region& region : body.regions)
    if (region.tets.empty())
      fail(
          "{}: region \"{}\" contains no tetrahedron; a box or a sphere selects tetrahedra by their "
          "centroids, and where regions overlap the last one applies",
          where, region.name);
  if (out.list.size() == 1) return out;
  counters::count("loop.regions");
  body.material_of_element.assign(static_cast<std::size_t>(body.rest.tets.cols()), 0);
  for (const Region& region : body.regions)
    for (const int tet : region.tets)
      body.material_of_element[static_cast<std::size_t>(tet)] = region.material;
  out.of_element = body.material_of_element;
  return out;
}

}  // namespace palpate::loop
