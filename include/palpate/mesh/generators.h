#pragma once
#include <array>

#include "palpate/core/registry.h"
#include "palpate/mesh/mesh.h"
#include "palpate/mesh/spec.h"

/// Meshes of known shape, bitwise deterministic.  All are centred at the origin except `corner_tet`, which
/// has a corner there.  `grading` = element size in the middle / at the surface, in [0.5, 32]; 1 is uniform.
namespace palpate::mesh {

/// Builds a box of edge lengths `size` [m], centred at the origin: five tetrahedra per cell, mirrored from
/// cell to cell so that faces match.  Graded: cells grow towards the middle along each axis.  Smallest
/// dihedral of cubic cells: 54.7 degrees.
TetMesh box(const Vec3& size, const std::array<int, 3>& cells, double grading = 1.0);
/// Builds the boundary of box().
TriMesh box_surface(const Vec3& size, const std::array<int, 3>& cells, double grading = 1.0);

/// Builds a ball around the origin from concentric icosahedral shells; boundary nodes lie on the sphere.
/// Edges at the surface are about `element_size` long [m].  For grading >= sqrt(2) the shells halve their
/// frequency towards the centre, as far as their number allows, so that elements become larger.  Smallest
/// dihedral above 36 degrees when uniform, above 20 at any grading (tests/mesh/generators_test.cpp).
TetMesh ball(double radius, double element_size, double grading = 1.0);

/// Builds a triangulated sphere: each edge of an icosahedron is cut into `subdivisions` parts, which gives 20
/// n^2 faces with vertices on the sphere.
TriMesh sphere(double radius, int subdivisions);
int sphere_subdivisions(double radius, double element_size);  ///< subdivisions that ball() uses at its
                                                              ///< surface

/// Builds a cylinder around the z axis, z in [-length/2, length/2] [m]: a disc of triangle rings, extruded.
/// Graded in the radius and along z, so that elements at the middle of the end faces and of the wall are
/// flat: smallest dihedral above 30 degrees when uniform, about 35 / grading otherwise.
TetMesh cylinder(double radius, double length, double element_size, double grading = 1.0);
/// Builds the boundary of cylinder().
TriMesh cylinder_surface(double radius, double length, double element_size, double grading = 1.0);

/// Builds one tetrahedron with a corner at the origin and the others at size.x, size.y, size.z along the axes
/// [m].
TetMesh corner_tet(const Vec3& size);

/// Moves each interior node at random by up to `amplitude` times its shortest edge (irregular meshes for
/// patch tests).  An amplitude of 0.2 is safe on the generators above.
/// @throws Error for an amplitude outside [0, 1), or if an element would be inverted
TetMesh perturbed(TetMesh mesh, double amplitude, unsigned seed);

/// Makes tetrahedra of a spec; checks the spec's sizes first.
using MakeTets = TetMesh (*)(const MeshSpec&);
/// Makes a surface of a spec; checks the spec's sizes first.
using MakeSurface = TriMesh (*)(const MeshSpec&);
/// Returns the generators of tetrahedra, by their name in `mesh.generator`.
const Registry<MakeTets>& tet_generators();
/// Returns the generators of closed surfaces, by the same names.
const Registry<MakeSurface>& surface_generators();
/// Returns the keys of a mesh that comes from a file.
std::vector<PartKey> file_keys();

}  // namespace palpate::mesh
