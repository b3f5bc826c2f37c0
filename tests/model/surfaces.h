#pragma once
#include <functional>
#include <string>

#include "model/repair.h"
#include "palpate/core/error.h"
#include "palpate/mesh/boundary.h"
#include "palpate/mesh/generators.h"

/// Surfaces with known results, and ways to damage them.
namespace surfaces {

using namespace palpate;

inline TriMesh ball(double radius = 1.0, int subdivisions = 8, const Vec3& centre = Vec3::Zero()) {
  TriMesh out = mesh::sphere(radius, subdivisions);
  out.vertices.colwise() += centre;
  return out;
}

inline TriMesh box() { return mesh::box_surface(Vec3(2, 1, 1), {8, 4, 4}); }

inline TriMesh together(const TriMesh& a, const TriMesh& b) {
  TriMesh out{Points(3, a.vertices.cols() + b.vertices.cols()), Faces(3, a.faces.cols() + b.faces.cols())};
  out.vertices << a.vertices, b.vertices;
  out.faces << a.faces, (b.faces.array() + static_cast<int>(a.vertices.cols())).matrix();
  return out;
}

inline TriMesh turned(TriMesh mesh) {
  mesh.faces.row(1).swap(mesh.faces.row(2));
  return mesh;
}

/// Removes the faces for whose centres `drop` holds.
inline TriMesh without(const TriMesh& mesh, const std::function<bool(const Vec3&)>& drop) {
  TriMesh out{mesh.vertices, Faces(3, mesh.faces.cols())};
  Eigen::Index kept = 0;
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) {
    Vec3 middle = Vec3::Zero();
    for (int k = 0; k < 3; ++k) middle += mesh.vertices.col(mesh.faces(k, f)) / 3;
    if (!drop(middle)) out.faces.col(kept++) = mesh.faces.col(f);
  }
  out.faces.conservativeResize(3, kept);
  return out;
}

/// Separates the vertices of all faces, as in STL.
inline TriMesh loose(const TriMesh& mesh) {
  TriMesh out{Points(3, 3 * mesh.faces.cols()), Faces(3, mesh.faces.cols())};
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f)
    for (int k = 0; k < 3; ++k) {
      out.vertices.col(3 * f + k) = mesh.vertices.col(mesh.faces(k, f));
      out.faces(k, f) = static_cast<int>(3 * f) + k;
    }
  return out;
}

inline mesh::Provenance from() { return mesh::surface_provenance("test.obj"); }

inline model::RepairedSurface repaired(const TriMesh& mesh, const model::RepairOptions& options = {}) {
  return model::repair(mesh, from(), options);
}

/// Returns the message of the Error that `work` throws; "accepted" if it throws none.
template <class Work>
std::string refusal(Work work) {
  try {
    work();
  } catch (const Error& e) { return e.what(); }
  return "accepted";
}

inline double volume(const TriMesh& mesh) { return mesh::enclosed_volume(mesh); }

}  // namespace surfaces
