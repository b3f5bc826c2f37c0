#include "lattice.h"
#include "palpate/mesh/generators.h"

namespace palpate::mesh {
namespace {

// About 8 GB in a simulation; a larger number is more likely a wrong unit than intended.
constexpr double kMaxElements = 2e7;

void require_length(const MeshSpec& spec, std::string_view key, double value) {
  if (!MeshRanges::length.holds(value))
    fail("generator \"{}\": {} = {} {}", spec.generator, key, value, MeshRanges::length.demand());
}

/// Checks the sizes.  The edges of a box around the body bound the number of elements before any is made;
/// each direction has at least one.
void require_sizes(const MeshSpec& spec, const Vec3& edges) {
  const double h = spec.element_size_m;
  require_length(spec, "element_size_m", h);
  if (!MeshRanges::grading.holds(spec.grading))
    fail("generator \"{}\": grading = {} {}", spec.generator, spec.grading, MeshRanges::grading.demand());
  const double elements = 5 * (edges / h).cwiseMax(1.0).prod();
  if (elements > kMaxElements)
    fail(
        "generator \"{}\": element_size_m = {} gives about {:.1e} elements, more than {:.0e}; use a larger "
        "size",
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

/// Returns the required and optional keys of a generator.
std::vector<PartKey> generator_keys(const std::vector<std::string>& needed,
                                    const std::vector<std::string>& taken) {
  std::vector<PartKey> keys = part_keys(needed);
  for (PartKey& key : keys) key.required = true;
  for (PartKey& key : part_keys(taken)) keys.push_back(std::move(key));
  return keys;
}
std::vector<PartKey> box_keys() { return generator_keys({"size_m", "element_size_m"}, {"grading"}); }
std::vector<PartKey> cylinder_keys() {
  return generator_keys({"radius_m", "length_m", "element_size_m"}, {"grading"});
}

}  // namespace

const Registry<MakeTets>& tet_generators() {
  static const Registry<MakeTets> out = {
      {"box", "box of size_m around the origin, five tetrahedra per cell", 0, make_box, box_keys()},
      {"ball", "ball of radius_m around the origin, icosahedral shells", 0, make_ball,
       generator_keys({"radius_m", "element_size_m"}, {"grading"})},
      {"cylinder", "cylinder of radius_m and length_m around z, centred", 0, make_cylinder, cylinder_keys()},
      {"tet", "one tetrahedron with a corner at the origin and legs size_m", 0, make_tet,
       generator_keys({"size_m"}, {})},
  };
  return out;
}

std::vector<PartKey> file_keys() { return part_keys({"scale"}); }

const Registry<MakeSurface>& surface_generators() {
  static const Registry<MakeSurface> out = {
      {"box", "surface of the box of tetrahedra", 0, make_box_surface, box_keys()},
      {"ball", "sphere of triangles, an icosahedron subdivided", 0, make_ball_surface,
       generator_keys({"radius_m", "element_size_m"}, {})},
      {"cylinder", "surface of the cylinder of tetrahedra", 0, make_cylinder_surface, cylinder_keys()},
  };
  return out;
}

}  // namespace palpate::mesh
