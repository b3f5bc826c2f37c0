#include "ball.h"
#include "gear.h"
#include "head.h"
#include "human.h"
#include "palpate/core/error.h"
#include "pumpkin.h"
#include "shapes/shapes.h"

namespace palpate::shapes {
namespace {

int settled(int asked, int usual, int least, const std::string& name, const char* of) {
  if (asked == 0) return usual;
  if (asked < least || asked > 4000000)
    fail("shape \"{}\": {} = {} must lie in [{}, 4000000]: fewer lose its smallest parts; 0 selects {}", name,
         of, asked, least, usual);
  return asked;
}

}  // namespace

const std::vector<ShapeEntry>& shapes() {
  static const std::vector<ShapeEntry> registry = {
      {"head",
       "a head, 0.24 m from chin to crown: face, ears, combed hair, wrinkled skin",
       {44000, 12000},
       {10000, 2000},
       make_head},
      {"human",
       "a person, 1.75 m, standing, arms away from the body; 19 bones",
       {40000, 12000},
       {20000, 5000},
       make_human},
      {"gear",
       "a spur gear, 0.10 m across, 23 involute teeth of module 4 mm: hub, web, bore, chamfers",
       {29000, 12000},
       {12000, 8000},
       make_gear},
      {"pumpkin", "a pumpkin, 0.30 m across, 12 ribs and a stem", {30000, 10000}, {6000, 2000}, make_pumpkin},
      {"ball", "a smooth ball, 0.06 m across", {6000, 1000}, {1000, 300}, make_ball},
  };
  return registry;
}

Shape make(const std::string& name, Resolution resolution) {
  const ShapeEntry& entry = find(shapes(), name, "shape");
  resolution.skin_vertices = settled(resolution.skin_vertices, entry.usual.skin_vertices,
                                     entry.least.skin_vertices, name, "skin_vertices");
  resolution.base_vertices = settled(resolution.base_vertices, entry.usual.base_vertices,
                                     entry.least.base_vertices, name, "base_vertices");
  return entry.make(resolution);
}

}  // namespace palpate::shapes
