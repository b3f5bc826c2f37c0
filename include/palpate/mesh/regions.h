#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// Elements of one material: a name, and factors on what the scene gives the body.  An element may be in
/// several (physical groups of Gmsh overlap); what is in none of them is of the body's own material.
struct MaterialRegion {
  std::string name;                    ///< of the region, unique in the mesh
  std::vector<int> tets;               ///< ascending
  double youngs_modulus_factor = 1.0;  ///< of the body's own Young's modulus
  double density_factor = 1.0;         ///< of the body's own density
};

}  // namespace palpate

namespace palpate::mesh {

/// Order in which regions take elements that several hold, so that the last one has them: from the largest to
/// the smallest, equal ones as they are listed.  A part of a region is more specific than the whole.
std::vector<int> by_falling_size(const std::vector<MaterialRegion>& regions);

/// Number of the region of each of `tets` elements, the smallest of those that hold it; -1: none.
std::vector<int> region_of_element(const std::vector<MaterialRegion>& regions, int tets);

/// Regions by groups of elements that may overlap, ascending by number.  Groups of the same name are one; a
/// number without a name is called "region-NUMBER".  A single group without a name that holds all elements is
/// no region: the file distinguishes nothing.
/// @param groups  ascending elements of each number  @param names  of the numbers that have one
/// @param tets  number of all elements
std::vector<MaterialRegion> regions_of_groups(std::map<double, std::vector<int>> groups,
                                              const std::map<double, std::string>& names, std::size_t tets);

/// Regions by the number that a file gives each tetrahedron, named as regions_of_groups() does.
/// @param labels  of each tetrahedron  @param names  of the numbers that have one
/// @param none  a number that stands for no region, where there is such a one
std::vector<MaterialRegion> regions_of_labels(const std::vector<double>& labels,
                                              const std::map<double, std::string>& names = {},
                                              std::optional<double> none = {});

}  // namespace palpate::mesh
