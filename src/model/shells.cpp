#include "shells.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "palpate/core/error.h"
#include "palpate/mesh/boundary.h"

namespace palpate::model {
namespace {

constexpr double kSpeck = 1e-4;  // [volumes of the largest shell]

struct Shell {
  std::vector<int> faces;
  double volume = 0.0;       // signed: positive if oriented outwards
  std::vector<int> holders;  // shells around it
};

double signed_volume(const TriMesh& surface, const std::vector<int>& faces) {
  const Vec3 o = surface.vertices.col(surface.faces(0, faces[0]));
  double volume = 0;
  for (const int f : faces) {
    const Vec3 a = surface.vertices.col(surface.faces(0, f)) - o,
               b = surface.vertices.col(surface.faces(1, f)) - o,
               c = surface.vertices.col(surface.faces(2, f)) - o;
    volume += a.dot(b.cross(c)) / 6;
  }
  return volume;
}

std::vector<Shell> measured(const TriMesh& surface) {
  std::vector<Shell> out;
  for (std::vector<int>& faces : shells_of(surface)) {
    const double volume = signed_volume(surface, faces);
    out.push_back({std::move(faces), volume, {}});
  }
  return out;
}

void find_holders(const TriMesh& surface, std::vector<Shell>& shells) {
  for (Shell& inner : shells)
    for (std::size_t o = 0; o < shells.size(); ++o)
      if (&shells[o] != &inner &&
          std::abs(mesh::winding_number(surface, shells[o].faces,
                                        surface.vertices.col(surface.faces(0, inner.faces[0])))) > 0.5)
        inner.holders.push_back(static_cast<int>(o));
}

std::string bodies_text(const Soup& soup, const std::vector<Shell>& shells,
                        const std::vector<std::size_t>& bodies) {
  std::string out;
  for (std::size_t i = 0; i < std::min<std::size_t>(bodies.size(), 3); ++i)
    out += fmt::format("{}{:.4g} m^3 from {}", i ? ", " : "", std::abs(shells[bodies[i]].volume),
                       soup.face_name(shells[bodies[i]].faces[0]));
  return out + (bodies.size() > 3 ? ", ..." : "");
}

}  // namespace

std::vector<std::vector<int>> shells_of(const TriMesh& surface) {
  const auto faces = static_cast<std::size_t>(surface.faces.cols());
  std::vector<std::array<int, 3>> edges;  // two vertices, ascending, and the face
  for (int f = 0; f < static_cast<int>(faces); ++f)
    for (int k = 0; k < 3; ++k) {
      const int a = surface.faces(k, f), b = surface.faces((k + 1) % 3, f);
      edges.push_back({std::min(a, b), std::max(a, b), f});
    }
  std::sort(edges.begin(), edges.end());
  std::vector<int> root(faces);
  for (std::size_t f = 0; f < faces; ++f) root[f] = static_cast<int>(f);
  const auto find = [&](int f) {
    while (root[static_cast<std::size_t>(f)] != f)
      f = root[static_cast<std::size_t>(f)] =
          root[static_cast<std::size_t>(root[static_cast<std::size_t>(f)])];
    return f;
  };
  for (std::size_t i = 1; i < edges.size(); ++i)
    if (edges[i][0] == edges[i - 1][0] && edges[i][1] == edges[i - 1][1]) {
      const int a = find(edges[i - 1][2]), b = find(edges[i][2]);
      root[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
  std::vector<int> number(faces, -1);
  std::vector<std::vector<int>> out;
  for (int f = 0; f < static_cast<int>(faces); ++f) {
    int& shell = number[static_cast<std::size_t>(find(f))];
    if (shell < 0) {
      shell = static_cast<int>(out.size());
      out.emplace_back();
    }
    out[static_cast<std::size_t>(shell)].push_back(f);
  }
  return out;
}

Soup keep_one_body(const Soup& soup, bool largest, std::vector<std::string>& notes) {
  const TriMesh surface = soup.surface();
  std::vector<Shell> shells = measured(surface);
  double most = 0;
  for (const Shell& shell : shells) most = std::max(most, std::abs(shell.volume));
  const double rounding = 1e-12 * std::pow(soup.diagonal(), 3);
  if (!(most > rounding))
    fail("{}: the surface encloses no volume ({:.3g} m^3); the surface of a body must enclose one",
         soup.face_name(0), most);
  if (const auto specks =
          std::erase_if(shells, [&](const Shell& s) { return std::abs(s.volume) < kSpeck * most; }))
    notes.push_back(fmt::format("{} shells smaller than 1e-4 of the largest were removed", specks));
  find_holders(surface, shells);

  std::vector<std::size_t> bodies;
  for (std::size_t s = 0; s < shells.size(); ++s)
    if (shells[s].holders.empty()) bodies.push_back(s);
  std::stable_sort(bodies.begin(), bodies.end(), [&](std::size_t a, std::size_t b) {
    return std::abs(shells[a].volume) > std::abs(shells[b].volume);
  });
  if (bodies.size() > 1 && !largest)
    fail(
        "{}: the surface is {} separate bodies: {}; a model has one: put each into a separate file, or keep "
        "the largest with --largest-shell",
        soup.from->source, bodies.size(), bodies_text(soup, shells, bodies));
  if (bodies.size() > 1)
    notes.push_back(fmt::format("the largest of {} separate bodies was kept", bodies.size()));
  const int body = static_cast<int>(bodies[0]);
  const bool inside_out = shells[bodies[0]].volume < 0;
  if (inside_out) notes.emplace_back("the surface was reoriented outwards");

  Soup out = soup;
  out.faces.clear();
  out.face_source.clear();
  const auto keep = [&](const Shell& shell) {
    for (const int f : shell.faces) {
      out.faces.push_back(soup.faces[static_cast<std::size_t>(f)]);
      if (inside_out) std::swap(out.faces.back()[1], out.faces.back()[2]);
      out.face_source.push_back(soup.face_source[static_cast<std::size_t>(f)]);
    }
  };
  keep(shells[bodies[0]]);
  const auto is_cavity = [&](const Shell& shell) {
    return (shell.volume > 0) == inside_out && shell.holders == std::vector<int>{body};
  };
  int solid = 0, cavities = 0, islands = 0;
  for (const Shell& shell : shells) {
    if (std::find(shell.holders.begin(), shell.holders.end(), body) == shell.holders.end()) continue;
    if (is_cavity(shell)) {
      keep(shell);
      ++cavities;
    } else if (std::any_of(shell.holders.begin(), shell.holders.end(),
                           [&](int holder) { return is_cavity(shells[static_cast<std::size_t>(holder)]); })) {
      ++islands;
    } else {
      ++solid;
    }
  }
  if (solid > 0) notes.push_back(fmt::format("{} inner shells were removed: the body is solid there", solid));
  if (islands > 0)
    notes.push_back(fmt::format("{} shells in cavities were removed: they are separate bodies", islands));
  if (cavities > 0)
    notes.push_back(fmt::format("{} inner shells face inwards and were kept as cavities", cavities));
  drop_unused(out);
  return out;
}

}  // namespace palpate::model
