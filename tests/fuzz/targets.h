#pragma once
#include <string>
#include <string_view>
#include <vector>

/// Readers of untrusted bytes, one entry per format. libFuzzer searches for inputs that break them
/// (libfuzzer.cpp, the preset `fuzz`); replay_test.cpp runs every input of corpus/NAME, and mutations of it,
/// in the default tests. A new target consists of its function in a separate file, a line in targets.cpp and
/// in CMakeLists.txt, and seeds in corpus/NAME.
namespace palpate::fuzz {

struct Target {
  std::string name;   ///< also the name of its corpus
  std::string reads;  ///< description, one line
  /// Reads the bytes or rejects them by palpate::Error with a message. Anything else is a finding: another
  /// exception, a signal, a result that violates the reader's contract (std::logic_error).
  void (*run)(std::string_view bytes);
};

const std::vector<Target>& targets();

/// @throws std::invalid_argument for an unknown name
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
void viewer_message(std::string_view bytes);
void medit(std::string_view bytes);
void vtu(std::string_view bytes);
void vtk(std::string_view bytes);
void polygons(std::string_view bytes);

}  // namespace palpate::fuzz
