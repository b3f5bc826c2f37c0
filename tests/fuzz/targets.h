#pragma once
#include <string>
#include <string_view>
#include <vector>

/// What reads bytes that somebody else wrote, one entry a format.  libFuzzer looks for inputs that break them
/// (libfuzzer.cpp, the preset `fuzz`); replay_test.cpp gives them every input of corpus/NAME, and mutations
/// of it, in the default tests.
///
/// A new one is its function in a file of its own, a line in targets.cpp and in CMakeLists.txt, and seeds in
/// corpus/NAME.
namespace palpate::fuzz {

struct Target {
  std::string name;   ///< of its corpus too
  std::string reads;  ///< one line
  /// Reads the bytes or refuses them by palpate::Error with a message.  Anything else is a finding: another
  /// exception, a signal, a result that breaks what the reader promises (std::logic_error).
  void (*run)(std::string_view bytes);
};

const std::vector<Target>& targets();

/// @throws std::invalid_argument for a name that is not there
const Target& target(std::string_view name);

void scene(std::string_view bytes);
void obj(std::string_view bytes);
void gmsh(std::string_view bytes);
void tetgen(std::string_view bytes);
void mesh_file(std::string_view bytes);
void model_file(std::string_view bytes);
void run_file(std::string_view bytes);
void checkpoint_file(std::string_view bytes);
void mesh_content(std::string_view bytes);
void model_content(std::string_view bytes);
void run_content(std::string_view bytes);
void checkpoint_content(std::string_view bytes);
void udp_packet(std::string_view bytes);
void recording(std::string_view bytes);
void results(std::string_view bytes);
void medit(std::string_view bytes);
void vtu(std::string_view bytes);
void vtk(std::string_view bytes);
void polygons(std::string_view bytes);

}  // namespace palpate::fuzz
