#pragma once
#include <optional>
#include <string>

namespace palpate::cli {

/// Arguments of `palpate export`.
struct ExportArguments {
  std::string run;             ///< folder of a run, or a file of states
  std::string to;              ///< "vtu", "obj", "ply", "csv" or "gltf"
  std::string folder;          ///< empty: one named after the format, beside the states
  std::string body;            ///< only this one, a tool or a bone; empty: all
  std::optional<double> at_s;  ///< only the state nearest to this time
  std::optional<int> step;     ///< only this state
  int every = 1;               ///< each Nth of all states
  bool no_skin = false;        ///< surfaces of the tetrahedra instead of skins
};

/// Writes the states of a run in another format.  @return the exit status
int export_run(const ExportArguments& arguments);

}  // namespace palpate::cli
