#include "lattice.h"
#include "palpate/mesh/generators.h"

namespace palpate::mesh {
namespace {

// about 8 GB in a simulation; beyond it a wrong unit is likelier than a wish
constexpr double kMaxElements = 2e7;

void require_length(const MeshSpec& spec, std::string_view key, double value) {
  if (!(value > 0 && value < 1e6))
    fail("generator \"{}\": {} = {} must lie in (0, 1e6) m", spec.generator, key, value);
}

/// The edges of a box around the body bound the number of elements before any is made;
/// each direction has one at least.
void require_sizes(const MeshSpec& spec, const Vec3& edges) {
  const double h = spec.element_size_m;
  require_length(spec, "element_size_m", h);
  if (!(spec.grading >= 0.5 && spec.grading <= 32))
    fail("generator \"{}\": grading = {} must lie in [0.5, 32]; 1 is uniform", spec.generator, spec.grading);
  const double elements = 5 * (edges / h).cwiseMax(1.0).prod();
  if (elements > kMaxElements)
    fail(
        "generator \"{}\": element_size_m = {} would make about {:.1e} elements, more than {:.0e}; use a "
        "larger one",
        spec.generator, h, elements, kMaxElements);
}

void check_box(const MeshSpec& spec) {
  for (int k = 0; k < 3; ++k) require_length(spec, fmt::format("size_m[{}]", k), spec.size_m[k]);
  require_sizes(spec, spec.size_m);
}
void check_ball(const MeshSpec& spec) {
  require_length(spec, "radius_m", spec.radius_m);
  require_sizes(spec, Vec3::Constant(2 * spec.radius_m));
}
void check_cylinder(const MeshSpec& spec) {
  require_length(spec, "radius_m", spec.radius_m);
  require_length(spec, "length_m", spec.length_m);
  require_sizes(spec, {2 * spec.radius_m, 2 * spec.radius_m, spec.length_m});
}

std::array<int, 3> box_cells(const MeshSpec& spec) {
  std::array<int, 3> out{};
  for (int k = 0; k < 3; ++k)
    out[static_cast<std::size_t>(k)] = graded_cells(spec.size_m[k], spec.element_size_m, spec.grading);
  return out;
}

TetMesh make_box(const MeshSpec& s) { return check_box(s), box(s.size_m, box_cells(s), s.grading); }
TetMesh make_ball(const MeshSpec& s) { return check_ball(s), ball(s.radius_m, s.element_size_m, s.grading); }
TetMesh make_cylinder(const MeshSpec& s) {
  return check_cylinder(s), cylinder(s.radius_m, s.length_m, s.element_size_m, s.grading);
}
TetMesh make_tet(const MeshSpec& s) {
  for (int k = 0; k < 3; ++k) require_length(s, fmt::format("size_m[{}]", k), s.size_m[k]);
  return corner_tet(s.size_m);
}
TriMesh make_box_surface(const MeshSpec& s) {
  return check_box(s), box_surface(s.size_m, box_cells(s), s.grading);
}
TriMesh make_ball_surface(const MeshSpec& s) {
  return check_ball(s), sphere(s.radius_m, sphere_subdivisions(s.radius_m, s.element_size_m));
}
TriMesh make_cylinder_surface(const MeshSpec& s) {
  return check_cylinder(s), cylinder_surface(s.radius_m, s.length_m, s.element_size_m, s.grading);
}

}  // namespace

const Registry<MakeTets>& tet_generators() {
  static const Registry<MakeTets> out = {
      {"box", "box of size_m around the origin, five tetrahedra a cell", 0, make_box},
      {"ball", "ball of radius_m around the origin, icosahedral shells", 0, make_ball},
      {"cylinder", "cylinder of radius_m and length_m around z, centred", 0, make_cylinder},
      {"tet", "one tetrahedron with a corner at the origin and legs size_m", 0, make_tet},
  };
  return out;
}

const Registry<MakeSurface>& surface_generators() {
  static const Registry<MakeSurface> out = {
      {"box", "surface of the box of tetrahedra", 0, make_box_surface},
      {"ball", "sphere of triangles, an icosahedron subdivided", 0, make_ball_surface},
      {"cylinder", "surface of the cylinder of tetrahedra", 0, make_cylinder_surface},
  };
  return out;
}

}  // namespace palpate::mesh
