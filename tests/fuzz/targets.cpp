#include "fuzz/targets.h"

#include <stdexcept>

namespace palpate::fuzz {

const std::vector<Target>& targets() {
  static const std::vector<Target> all = {
      {"scene", "a scene (TOML)", scene},
      {"obj", "a surface (Wavefront OBJ)", obj},
      {"gmsh", "tetrahedra (Gmsh 2 and 4.1, ASCII)", gmsh},
      {"tetgen", "tetrahedra (TetGen's .node and .ele, a line \"====\" between them)", tetgen},
      {"mesh_file", "tetrahedra (HDF5)", mesh_file},
      {"model_file", "a layered model (HDF5)", model_file},
      {"run_file", "a recorded run (VTKHDF)", run_file},
      {"checkpoint_file", "a checkpoint (HDF5)", checkpoint_file},
      {"mesh_content", "changes to a good file of tetrahedra, made by HDF5", mesh_content},
      {"model_content", "changes to a good model, made by HDF5", model_content},
      {"run_content", "changes to a good run, made by HDF5", run_content},
      {"checkpoint_content", "changes to a good checkpoint, made by HDF5", checkpoint_content},
      {"udp_packet", "poses and wrenches from the network", udp_packet},
      {"recording", "recorded poses of a hand (CSV)", recording},
      {"results", "force.csv and summary.json of a run", results},
      {"viewer_message", "a message of a viewer of palpate touch (JSON), or a header of its handshake",
       viewer_message},
#ifdef PALPATE_FUZZ_FOREIGN
      {"medit", "a foreign mesh (Medit, binary)", medit},
      {"vtu", "a foreign mesh (VTK XML)", vtu},
      {"vtk", "foreign meshes (legacy VTK)", vtk},
      {"polygons", "a foreign surface (PLY, OFF or STL)", polygons},
#endif
  };
  return all;
}

const Target& target(std::string_view name) {
  std::string known;
  for (const Target& one : targets()) {
    if (one.name == name) return one;
    known += ' ' + one.name;
  }
  throw std::invalid_argument("no target \"" + std::string(name) + "\"; there are" + known);
}

}  // namespace palpate::fuzz
