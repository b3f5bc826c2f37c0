#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// Elements of one material: a name, and factors on the body's material parameters.  Regions may overlap
/// (physical groups of Gmsh do); elements in no region have the body's material.
struct MaterialRegion {
  std::string name;                    ///< name of the region, unique in the mesh
  std::vector<int> tets;               ///< ascending
  double youngs_modulus_factor = 1.0;  ///< factor on the body's Young's modulus
  double density_factor = 1.0;         ///< factor on the body's density
};

}  // namespace palpate

namespace palpate::mesh {

/// Returns the order in which regions take shared elements, so that the last one keeps them: from the largest
/// to the smallest, equal sizes in list order.  A part of a region is more specific than the whole.
std::vector<int> by_falling_size(const std::vector<MaterialRegion>& regions);

/// Returns for each of `tets` elements the index of the smallest region that contains it; -1: none.
std::vector<int> region_of_element(const std::vector<MaterialRegion>& regions, int tets);

/// Builds regions from groups of elements that may overlap, ascending by number.  Groups of the same name are
/// merged; a number without a name is called "region-NUMBER".  A single group without a name that holds all
/// elements yields no region, because it distinguishes nothing.
/// @param groups  ascending elements per number
/// @param names   names of some numbers
/// @param tets    number of all elements
std::vector<MaterialRegion> regions_of_groups(std::map<double, std::vector<int>> groups,
                                              const std::map<double, std::string>& names, std::size_t tets);

/// Builds regions from the number that a file assigns to each tetrahedron, named as by regions_of_groups().
/// @param labels  number per tetrahedron
/// @param names   names of some numbers
/// @param none    number that means "no region", if there is one
std::vector<MaterialRegion> regions_of_labels(const std::vector<double>& labels,
                                              const std::map<double, std::string>& names = {},
                                              std::optional<double> none = {});

}  // namespace palpate::mesh
