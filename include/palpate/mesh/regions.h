#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// Elements of one material: a name, and factors on what the scene gives the body.  Regions of a body have no
/// element in common; what is in none of them is of the body's own material.
struct MaterialRegion {
  std::string name;                    ///< of the region, unique in the mesh
  std::vector<int> tets;               ///< ascending
  double youngs_modulus_factor = 1.0;  ///< of the body's own Young's modulus
  double density_factor = 1.0;         ///< of the body's own density
};

}  // namespace palpate

namespace palpate::mesh {

/// Number of the region of each of `tets` elements, -1: none.  @pre no element in two
std::vector<int> region_of_element(const std::vector<MaterialRegion>& regions, int tets);

/// Regions by the number that a file gives each tetrahedron, ascending by number.  A number without a name is
/// called "region-NUMBER".  Where all have the same number, and it has no name, there are no regions: the
/// file distinguishes nothing.
/// @param labels  of each tetrahedron  @param names  of the numbers that have one
/// @param none  a number that stands for no region, where there is such a one
std::vector<MaterialRegion> regions_of_labels(const std::vector<double>& labels,
                                              const std::map<double, std::string>& names = {},
                                              std::optional<double> none = {});

}  // namespace palpate::mesh
