#include <dlfcn.h>
#include <gmshc.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <numeric>

#include "cells.h"
#include "palpate/core/error.h"
#include "palpate/core/rehearsal.h"

// libgmsh takes 0.12 s and 48 MB to load, so that it is opened by name at the first file that needs it, and
// only its C interface is used.
namespace palpate::model {
namespace {

class Gmsh {
 public:
  Gmsh() : handle_(::dlopen(PALPATE_GMSH_LIBRARY, RTLD_NOW | RTLD_LOCAL)) {
    if (!handle_)
      fail("{} cannot be loaded ({}); the package libgmsh4.8 brings it", PALPATE_GMSH_LIBRARY, ::dlerror());
    int error = 0;
    function<decltype(gmshInitialize)>("gmshInitialize")(0, nullptr, 0, &error);
    const auto option = function<decltype(gmshOptionSetNumber)>("gmshOptionSetNumber");
    option("General.Terminal", 0, &error);
    option("General.NumThreads", 1, &error);
  }
  ~Gmsh() {
    int error = 0;
    // the library stays loaded: it does not survive being unloaded
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
  /// What Gmsh says went wrong last.
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

/// An array that Gmsh allocated.
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

struct Kind {
  int type, corners;
  const char* name;
};
constexpr Kind kKinds[] = {{2, 3, "triangles"},
                           {3, 4, "quadrangles"},
                           {4, 4, "tetrahedra"},
                           {5, 8, "hexahedra"},
                           {6, 6, "prisms"},
                           {7, 5, "pyramids"},
                           {9, 6, "triangles of second order"},
                           {11, 10, "tetrahedra of second order"}};

/// The number and the name of the region of each volume: its first physical group, 0 for none; where no
/// volume has a group, the volumes themselves.
std::map<int, double> regions_of_volumes(const Gmsh& gmsh, Cells& cells) {
  int error = 0;
  Array<int> entities(gmsh);
  gmsh.function<decltype(gmshModelGetEntities)>("gmshModelGetEntities")(&entities.data, &entities.size, 3,
                                                                        &error);
  std::map<int, double> out;
  bool any = false;
  for (std::size_t i = 1; i < entities.size; i += 2) {  // pairs of dimension and tag
    Array<int> groups(gmsh);
    gmsh.function<decltype(gmshModelGetPhysicalGroupsForEntity)>("gmshModelGetPhysicalGroupsForEntity")(
        3, entities.data[i], &groups.data, &groups.size, &error);
    const int group = error || groups.size == 0 ? 0 : std::abs(groups.data[0]);
    out[entities.data[i]] = group;
    any = any || group != 0;
    if (group == 0) continue;
    char* name = nullptr;
    gmsh.function<decltype(gmshModelGetPhysicalName)>("gmshModelGetPhysicalName")(3, group, &name, &error);
    if (name && *name) cells.label_names[group] = name;
    if (name) gmsh.free(name);
  }
  if (any)
    cells.no_label = 0.0;
  else
    for (auto& [volume, label] : out) label = volume;
  return out;
}

/// The region label of each tetrahedron, by its tag.
std::map<std::size_t, double> labels_of_tetrahedra(const Gmsh& gmsh, Cells& cells) {
  std::map<std::size_t, double> out;
  for (const auto& [volume, label] : regions_of_volumes(gmsh, cells)) {
    int error = 0;
    Array<std::size_t> elements(gmsh), nodes(gmsh);
    gmsh.function<decltype(gmshModelMeshGetElementsByType)>("gmshModelMeshGetElementsByType")(
        4, &elements.data, &elements.size, &nodes.data, &nodes.size, volume, 0, 1, &error);
    for (std::size_t e = 0; !error && e < elements.size; ++e) out[elements.data[e]] = label;
  }
  return out;
}

SourceFile read_here(const std::string& path, const std::string& format) {
  const Gmsh gmsh;
  int error = 0;
  gmsh.function<decltype(gmshOpen)>("gmshOpen")(path.c_str(), &error);
  if (error) fail("{}: cannot be read as {}: Gmsh says: {}", path, format, gmsh.last_error());

  Cells cells(path);
  // tags may be sparse and in any order; sorted, they give the same numbering whatever the file's order
  std::map<std::size_t, int> place;
  {
    Array<std::size_t> tags(gmsh);
    Array<double> coordinates(gmsh), parameters(gmsh);
    gmsh.function<decltype(gmshModelMeshGetNodes)>("gmshModelMeshGetNodes")(
        &tags.data, &tags.size, &coordinates.data, &coordinates.size, &parameters.data, &parameters.size, -1,
        -1, 0, 0, &error);
    if (error || coordinates.size != 3 * tags.size)
      fail("{}: its nodes cannot be read: Gmsh says: {}", path, gmsh.last_error());
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
  const std::map<std::size_t, double> labels = labels_of_tetrahedra(gmsh, cells);
  for (const Kind& kind : kKinds) {
    Array<std::size_t> elements(gmsh), nodes(gmsh);
    gmsh.function<decltype(gmshModelMeshGetElementsByType)>("gmshModelMeshGetElementsByType")(
        kind.type, &elements.data, &elements.size, &nodes.data, &nodes.size, -1, 0, 1, &error);
    if (error) continue;  // no element of this type
    for (std::size_t e = 0; e < elements.size; ++e) {
      std::vector<int> corners;
      for (int k = 0; k < kind.corners; ++k) {
        const std::size_t tag =
            nodes.data[e * static_cast<std::size_t>(kind.corners) + static_cast<std::size_t>(k)];
        const auto at = place.find(tag);
        if (at == place.end())
          fail("{}: element {} names node {}, which the file does not have", path, elements.data[e], tag);
        corners.push_back(at->second);
      }
      if (kind.type == 2 || kind.type == 3)
        cells.polygon(corners);
      else if (kind.type == 4) {
        cells.tetrahedron(corners[0], corners[1], corners[2], corners[3]);
        const auto label = labels.find(elements.data[e]);
        cells.labels.push_back(label == labels.end() ? 0.0 : label->second);
      } else
        cells.unread(kind.name);
    }
  }
  return cells.finish(format);
}

}  // namespace

SourceFile read_by_gmsh(const std::string& path, const std::string& format) {
  return rehearsed(path, "Gmsh", [&] { return read_here(path, format); });
}

}  // namespace palpate::model
