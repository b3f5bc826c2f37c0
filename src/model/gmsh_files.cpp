#include <dlfcn.h>
#include <gmshc.h>

#include <algorithm>
#include <map>
#include <numeric>

#include "cells.h"
#include "palpate/core/error.h"

// libgmsh takes 0.12 s and 48 MB to load, so that it is opened by name at the first file that needs it, and only its C interface is used.
namespace palpate::model {
namespace {

class Gmsh {
 public:
  Gmsh() : handle_(::dlopen(PALPATE_GMSH_LIBRARY, RTLD_NOW | RTLD_LOCAL)) {
    if (!handle_) fail("{} cannot be loaded ({}); the package libgmsh4.8 brings it", PALPATE_GMSH_LIBRARY, ::dlerror());
    int error = 0;
    function<decltype(gmshInitialize)>("gmshInitialize")(0, nullptr, 0, &error);
    const auto option = function<decltype(gmshOptionSetNumber)>("gmshOptionSetNumber");
    option("General.Terminal", 0, &error);
    option("General.NumThreads", 1, &error);
  }
  ~Gmsh() {
    int error = 0;
    function<decltype(gmshFinalize)>("gmshFinalize")(&error);  // the library stays loaded: it does not survive being unloaded
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
constexpr Kind kKinds[] = {{2, 3, "triangles"}, {3, 4, "quadrangles"}, {4, 4, "tetrahedra"}, {5, 8, "hexahedra"}, {6, 6, "prisms"}, {7, 5, "pyramids"}, {9, 6, "triangles of second order"},
                           {11, 10, "tetrahedra of second order"}};

}  // namespace

SourceFile read_by_gmsh(const std::string& path, const std::string& format) {
  const Gmsh gmsh;
  int error = 0;
  gmsh.function<decltype(gmshOpen)>("gmshOpen")(path.c_str(), &error);
  if (error) fail("{}: cannot be read as {}: Gmsh says: {}", path, format, gmsh.last_error());

  Cells cells(path);
  std::map<std::size_t, int> place;  // tags may be sparse and in any order; sorted, they give the same numbering whatever the file's order
  {
    Array<std::size_t> tags(gmsh);
    Array<double> coordinates(gmsh), parameters(gmsh);
    gmsh.function<decltype(gmshModelMeshGetNodes)>("gmshModelMeshGetNodes")(&tags.data, &tags.size, &coordinates.data, &coordinates.size, &parameters.data, &parameters.size, -1, -1, 0, 0, &error);
    if (error || coordinates.size != 3 * tags.size) fail("{}: its nodes cannot be read: Gmsh says: {}", path, gmsh.last_error());
    std::vector<std::size_t> order(tags.size);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return tags.data[a] < tags.data[b]; });
    for (const std::size_t i : order) {
      if (!place.emplace(tags.data[i], static_cast<int>(cells.points.size())).second) continue;
      cells.points.emplace_back(coordinates.data[3 * i], coordinates.data[3 * i + 1], coordinates.data[3 * i + 2]);
      cells.point_numbers.push_back(static_cast<long>(tags.data[i]));
    }
  }
  for (const Kind& kind : kKinds) {
    Array<std::size_t> elements(gmsh), nodes(gmsh);
    gmsh.function<decltype(gmshModelMeshGetElementsByType)>("gmshModelMeshGetElementsByType")(kind.type, &elements.data, &elements.size, &nodes.data, &nodes.size, -1, 0, 1, &error);
    if (error) continue;  // no element of this type
    for (std::size_t e = 0; e < elements.size; ++e) {
      std::vector<int> corners;
      for (int k = 0; k < kind.corners; ++k) {
        const std::size_t tag = nodes.data[e * static_cast<std::size_t>(kind.corners) + static_cast<std::size_t>(k)];
        const auto at = place.find(tag);
        if (at == place.end()) fail("{}: element {} names node {}, which the file does not have", path, elements.data[e], tag);
        corners.push_back(at->second);
      }
      if (kind.type == 2 || kind.type == 3)
        cells.polygon(corners);
      else if (kind.type == 4)
        cells.tetrahedron(corners[0], corners[1], corners[2], corners[3]);
      else
        cells.unread(kind.name);
    }
  }
  return cells.finish(format);
}

}  // namespace palpate::model
