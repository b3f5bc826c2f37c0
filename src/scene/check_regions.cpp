#include <algorithm>

#include "scene/check.h"
#include "scene/reader.h"

namespace palpate::scene {
namespace {

/// Returns the way in which a region selects elements.
Selection chosen_by(const Document& doc, const std::string& key, const std::string& where,
                    const SoftBodySpec& body) {
  const std::optional<Selection> shape = box_or_sphere(doc, key, where);
  if (!shape && body.mesh.file.empty())
    refuse(location(doc, key), where,
           fmt::format("box_min_m is missing: generator = \"{}\" defines no regions; select elements by "
                       "box_min_m and box_max_m, or by centre_m and radius_m",
                       body.mesh.generator));
  return shape.value_or(Selection::kFile);
}

}  // namespace

// Names of regions are in the mesh file: whether they exist is checked when it is read.
void check_regions(const Document& doc, Description& d) {
  for (std::size_t i = 0; i < d.bodies.size(); ++i) {
    SoftBodySpec& body = d.bodies[i];
    Names names;
    for (std::size_t j = 0; j < body.regions.size(); ++j) {
      RegionSpec& region = body.regions[j];
      const std::string key = fmt::format("body[{}].region[{}]", i, j),
                        where = fmt::format("body \"{}\": region \"{}\"", body.name, region.name);
      region.region = chosen_by(doc, key, where, body);
      check_box(doc, key, where, region.box_min_m, region.box_max_m);
      if (std::find(names.begin(), names.end(), region.name) != names.end())
        refuse(location(doc, key + ".name"), where, "this region has two tables; merge them");
      names.push_back(region.name);
      if (!region.youngs_modulus_pa && !region.poissons_ratio && !region.density_kg_m3 &&
          !region.mass_damping_per_s && !region.stiffness_damping_s &&
          std::none_of(body.changes.begin(), body.changes.end(),
                       [&](const MaterialChangeSpec& c) { return c.region == region.name; }))
        refuse(location(doc, key), where,
               "sets no material: give youngs_modulus_pa, poissons_ratio, density_kg_m3, mass_damping_per_s "
               "or stiffness_damping_s, or remove it");
    }
    for (std::size_t j = 0; j < body.changes.size(); ++j) {
      const std::string& region = body.changes[j].region;
      if (region.empty() || std::find(names.begin(), names.end(), region) != names.end()) continue;
      const std::string key = fmt::format("body[{}].change[{}].region", i, j),
                        where = fmt::format("body \"{}\": change", body.name);
      if (names.empty())
        refuse(location(doc, key), where,
               fmt::format("region = \"{}\", but the body has no [[body.region]]", region));
      refuse(location(doc, key), where,
             fmt::format("no [[body.region]] is called \"{}\"{}", region, suggestion(region, names)));
    }
  }
}

}  // namespace palpate::scene
