#pragma once
#include <array>

#include "palpate/core/registry.h"
#include "palpate/mesh/mesh.h"
#include "palpate/mesh/spec.h"

/// Meshes with a known shape, deterministic to the last bit.  All are centred at the origin except the corner
/// of `corner_tet`. `grading` = element size in the middle / at the surface, in [0.5, 32]; 1 is uniform.
namespace palpate::mesh {

/// Box of edge lengths `size` [m], centred at the origin: five tetrahedra a cell, mirrored from cell to cell
/// so that faces match.  Graded: cells grow towards the middle along each axis.  Smallest dihedral of cubic
/// cells: 54.7 degrees.
TetMesh box(const Vec3& size, const std::array<int, 3>& cells, double grading = 1.0);
/// the boundary of box()
TriMesh box_surface(const Vec3& size, const std::array<int, 3>& cells, double grading = 1.0);

/// Ball around the origin of concentric icosahedral shells; boundary nodes lie on the sphere.  Edges about
/// `element_size` at the surface. grading >= sqrt(2): shells halve their frequency on the way in, as far as
/// their number allows, so that elements really get larger. Smallest dihedral above 36 degrees when uniform,
/// above 20 at any grading (tests/mesh/generators_test.cpp).
TetMesh ball(double radius, double element_size, double grading = 1.0);

/// Triangle sphere: each edge of an icosahedron cut into `subdivisions` parts, 20 n^2 faces, vertices on the
/// sphere.
TriMesh sphere(double radius, int subdivisions);
int sphere_subdivisions(double radius, double element_size);  ///< what ball() uses at its surface

/// Cylinder around the z axis, z in [-length/2, length/2]: rings of triangles, extruded.  Graded in the
/// radius and along z, so that elements at the middle of the end faces and of the wall are flat: smallest
/// dihedral above 30 degrees when uniform, about 35 / grading else.
TetMesh cylinder(double radius, double length, double element_size, double grading = 1.0);
/// the boundary of cylinder()
TriMesh cylinder_surface(double radius, double length, double element_size, double grading = 1.0);

/// One tetrahedron: a corner at the origin, the others at size.x, size.y, size.z along the axes.
TetMesh corner_tet(const Vec3& size);

/// Moves each interior node at random by up to `amplitude` times its shortest edge (irregular meshes for
/// patch tests); throws Error if an element would be inverted.  0.2 is safe on the generators above.
TetMesh perturbed(TetMesh mesh, double amplitude, unsigned seed);

/// Generators by the name in a scene; the spec's sizes are checked first.
using MakeTets = TetMesh (*)(const MeshSpec&);
/// Makes a surface of a spec whose numbers are checked.
using MakeSurface = TriMesh (*)(const MeshSpec&);
/// Generators of tetrahedra, by the name in `mesh.generator`.
const Registry<MakeTets>& tet_generators();
/// Generators of closed surfaces, by the same names.
const Registry<MakeSurface>& surface_generators();
/// Keys of a mesh that comes from a file.
std::vector<PartKey> file_keys();

}  // namespace palpate::mesh
