#include <dlfcn.h>
#include <gmshc.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <numeric>

#include "cells.h"
#include "core/sandbox.h"
#include "format_readers.h"
#include "gmsh_start.h"
#include "palpate/core/error.h"

// libgmsh takes 0.12 s and 48 MB to load.  It is therefore opened by dlopen at the first file that needs it,
// and only its C interface is used.
namespace palpate::model {
namespace {

class Gmsh {
 public:
  Gmsh() : handle_(::dlopen(PALPATE_GMSH_LIBRARY, RTLD_NOW | RTLD_LOCAL)) {
    if (!handle_) {
      std::string package = PALPATE_GMSH_LIBRARY;  // Debian's name: libgmsh4.8 for libgmsh.so.4.8
      if (const std::size_t at = package.find(".so."); at != std::string::npos) package.erase(at, 4);
      fail("{} cannot be loaded ({}); install the package {}", PALPATE_GMSH_LIBRARY, ::dlerror(), package);
    }
    int error = 0;
    start_gmsh(function<decltype(gmshInitialize)>("gmshInitialize"), &error);
    const auto option = function<decltype(gmshOptionSetNumber)>("gmshOptionSetNumber");
    option("General.Terminal", 0, &error);
    option("General.NumThreads", 1, &error);
  }
  ~Gmsh() {
    int error = 0;
    // The library stays loaded, because it crashes when it is unloaded.
    function<decltype(gmshFinalize)>("gmshFinalize")(&error);
  }
  Gmsh(const Gmsh&) = delete;
  Gmsh& operator=(const Gmsh&) = delete;

  template <class Signature>
  Signature* function(const char* name) const {
    void* const symbol = ::dlsym(handle_, name);
    PALPATE_CHECK(symbol, "{} has no {}", PALPATE_GMSH_LIBRARY, name);
    return reinterpret_cast<Signature*>(symbol);
  }
  /// Returns Gmsh's last error message.
  std::string last_error() const {
    char* text = nullptr;
    int error = 0;
    function<decltype(gmshLoggerGetLastError)>("gmshLoggerGetLastError")(&text, &error);
    std::string out = text ? text : "";
    if (text) free(text);
    return out.empty() ? "no reason given" : out;
  }
  void free(void* p) const { function<decltype(gmshFree)>("gmshFree")(p); }

 private:
  void* handle_;
};

/// Array allocated by Gmsh, freed on destruction.
template <class T>
struct Array {
  explicit Array(const Gmsh& owner) : gmsh(owner) {}
  ~Array() { gmsh.free(data); }
  Array(const Array&) = delete;
  Array& operator=(const Array&) = delete;
  const Gmsh& gmsh;
  T* data = nullptr;
  std::size_t size = 0;
};

/// Gmsh element type.
struct Kind {
  int type;
  std::size_t corners;  ///< 0: not read
  const char* name;
};
constexpr Kind kKinds[] = {{2, 3, "triangles"},
                           {3, 4, "quadrangles"},
                           {5, 0, "hexahedra"},
                           {6, 0, "prisms"},
                           {7, 0, "pyramids"},
                           {9, 0, "triangles of second order"},
                           {11, 0, "tetrahedra of second order"}};

/// Returns the physical volumes of each volume of the model, and stores their names.
std::map<int, std::vector<int>> groups_of_volumes(const Gmsh& gmsh, Cells& cells) {
  int error = 0;
  Array<int> entities(gmsh);
  gmsh.function<decltype(gmshModelGetEntities)>("gmshModelGetEntities")(&entities.data, &entities.size, 3,
                                                                        &error);
  std::map<int, std::vector<int>> out;
  for (std::size_t i = 1; i < entities.size; i += 2) {  // pairs of dimension and tag
    Array<int> groups(gmsh);
    gmsh.function<decltype(gmshModelGetPhysicalGroupsForEntity)>("gmshModelGetPhysicalGroupsForEntity")(
        3, entities.data[i], &groups.data, &groups.size, &error);
    std::vector<int>& of_volume = out[entities.data[i]];
    for (std::size_t g = 0; !error && g < groups.size; ++g) {
      const int group = std::abs(groups.data[g]);
      of_volume.push_back(group);
      char* name = nullptr;
      gmsh.function<decltype(gmshModelGetPhysicalName)>("gmshModelGetPhysicalName")(3, group, &name, &error);
      if (name && *name) cells.label_names[group] = name;
      if (name) gmsh.free(name);
    }
  }
  return out;
}

/// Elements of one type in one entity (-1: in all): tags, and tags of their nodes.
struct Elements {
  Elements(const Gmsh& gmsh, int type, int entity) : tags(gmsh), nodes(gmsh) {
    int error = 0;
    gmsh.function<decltype(gmshModelMeshGetElementsByType)>("gmshModelMeshGetElementsByType")(
        type, &tags.data, &tags.size, &nodes.data, &nodes.size, entity, 0, 1, &error);
    if (error) tags.size = nodes.size = 0;  // no elements of this type
  }
  Array<std::size_t> tags, nodes;
};

/// Returns the corners of element `e` as indices into the list of points.
std::vector<int> corners_of(const Elements& elements, std::size_t e, std::size_t count,
                            const std::map<std::size_t, int>& place, const std::string& path) {
  std::vector<int> out;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t tag = elements.nodes.data[e * count + k];
    const auto at = place.find(tag);
    if (at == place.end())
      fail("{}: element {} refers to node {}, which is not in the file", path, elements.tags.data[e], tag);
    out.push_back(at->second);
  }
  return out;
}

/// Reads the tetrahedra, volume by volume, with their groups; without groups the volumes are the groups.  In
/// versions 1 and 2, an element is listed once for each of its groups.
void read_tetrahedra(const Gmsh& gmsh, const std::map<std::size_t, int>& place, const std::string& path,
                     Cells& cells) {
  const std::map<int, std::vector<int>> volumes = groups_of_volumes(gmsh, cells);
  const bool grouped =
      std::any_of(volumes.begin(), volumes.end(), [](const auto& v) { return !v.second.empty(); });
  for (const auto& [volume, groups] : volumes) {
    const Elements elements(gmsh, 4, volume);
    std::map<std::array<int, 4>, std::size_t> times;
    for (std::size_t e = 0; e < elements.tags.size; ++e) {
      const std::vector<int> c = corners_of(elements, e, 4, place, path);
      std::array<int, 4> sorted{c[0], c[1], c[2], c[3]};
      std::sort(sorted.begin(), sorted.end());
      if (groups.size() > 1) {
        if (std::size_t& met = times[sorted]; ++met > 1 && met <= groups.size()) continue;
      }
      const auto tet = static_cast<int>(cells.tetrahedra());
      cells.tetrahedron(c[0], c[1], c[2], c[3]);
      if (!grouped) cells.groups[volume].push_back(tet);
      for (const int group : groups) cells.groups[group].push_back(tet);
    }
  }
}

SourceFile mesh_in(const std::string& path, const std::string& format) {
  const Gmsh gmsh;
  int error = 0;
  gmsh.function<decltype(gmshOpen)>("gmshOpen")(path.c_str(), &error);
  if (error) fail("{}: cannot be read as {}: Gmsh reports: {}", path, format, gmsh.last_error());

  Cells cells(path);
  // Tags may be sparse and in any order; sorting makes the numbering independent of the file's order.
  std::map<std::size_t, int> place;
  {
    Array<std::size_t> tags(gmsh);
    Array<double> coordinates(gmsh), parameters(gmsh);
    gmsh.function<decltype(gmshModelMeshGetNodes)>("gmshModelMeshGetNodes")(
        &tags.data, &tags.size, &coordinates.data, &coordinates.size, &parameters.data, &parameters.size, -1,
        -1, 0, 0, &error);
    if (error || coordinates.size != 3 * tags.size)
      fail("{}: its nodes cannot be read: Gmsh reports: {}", path, gmsh.last_error());
    std::vector<std::size_t> order(tags.size);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return tags.data[a] < tags.data[b]; });
    for (const std::size_t i : order) {
      if (!place.emplace(tags.data[i], static_cast<int>(cells.points.size())).second) continue;
      cells.points.emplace_back(coordinates.data[3 * i], coordinates.data[3 * i + 1],
                                coordinates.data[3 * i + 2]);
      cells.point_numbers.push_back(static_cast<long>(tags.data[i]));
    }
  }
  read_tetrahedra(gmsh, place, path, cells);
  for (const Kind& kind : kKinds) {
    const Elements elements(gmsh, kind.type, -1);
    for (std::size_t e = 0; e < elements.tags.size; ++e)
      if (kind.corners > 0)
        cells.polygon(corners_of(elements, e, kind.corners, place, path));
      else
        cells.unread(kind.name);
  }
  return cells.finish(format);
}

}  // namespace

SourceFile read_by_gmsh(const std::string& path, const std::string& format) {
  return rehearsed(path, "Gmsh", [&] { return mesh_in(path, format); });
}

}  // namespace palpate::model
