#include "cgal_surface.h"

#include <CGAL/Polygon_mesh_processing/self_intersections.h>

#include <set>

#include "crossings.h"

namespace palpate::model {

CgalSurface cgal_of(const Soup& soup) {
  CgalSurface mesh;
  auto vertex_source = mesh.add_property_map<CgalSurface::Vertex_index, int>("v:source", -1).first;
  auto face_source = mesh.add_property_map<CgalSurface::Face_index, int>("f:source", -1).first;
  for (std::size_t v = 0; v < soup.vertices.size(); ++v)
    vertex_source[mesh.add_vertex({soup.vertices[v].x(), soup.vertices[v].y(), soup.vertices[v].z()})] =
        soup.vertex_source[v];
  for (std::size_t f = 0; f < soup.faces.size(); ++f) {
    const auto index = [&](int k) {
      return CgalSurface::Vertex_index(
          static_cast<CgalSurface::size_type>(soup.faces[f][static_cast<std::size_t>(k)]));
    };
    const auto face = mesh.add_face(index(0), index(1), index(2));
    if (face == CgalSurface::null_face())
      fail(
          "{}: this face cannot be joined to its neighbours: more than two faces meet at an edge, or they "
          "touch at a point only",
          soup.face_name(static_cast<int>(f)));
    face_source[face] = soup.face_source[f];
  }
  return mesh;
}

Soup soup_of(CgalSurface& mesh, const mesh::Provenance& from) {
  mesh.collect_garbage();
  Soup out;
  out.from = &from;
  const auto vertex_source = mesh.add_property_map<CgalSurface::Vertex_index, int>("v:source", -1).first;
  const auto face_source = mesh.add_property_map<CgalSurface::Face_index, int>("f:source", -1).first;
  for (const auto v : mesh.vertices()) {
    const auto& p = mesh.point(v);
    out.vertices.emplace_back(p.x(), p.y(), p.z());
    out.vertex_source.push_back(vertex_source[v]);
  }
  for (const auto f : mesh.faces()) {
    std::array<int, 3> corners{};
    std::size_t k = 0;
    for (const auto v : mesh.vertices_around_face(mesh.halfedge(f))) corners.at(k++) = static_cast<int>(v);
    out.faces.push_back(corners);
    out.face_source.push_back(face_source[f]);
  }
  return out;
}

std::vector<int> crossing_faces(const Soup& soup) {
  return guarded(soup, [&] {
    const CgalSurface mesh = cgal_of(soup);
    std::vector<std::pair<CgalSurface::Face_index, CgalSurface::Face_index>> pairs;
    CGAL::Polygon_mesh_processing::self_intersections<CGAL::Sequential_tag>(mesh, std::back_inserter(pairs));
    std::set<int> faces;
    for (const auto& [a, b] : pairs) faces.insert({static_cast<int>(a), static_cast<int>(b)});
    return std::vector<int>(faces.begin(), faces.end());
  });
}

}  // namespace palpate::model
