#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace palpate::cli {

/// A command that another program runs, installed in the same folder.
struct OtherProgram {
  std::string_view command;  ///< "bench"
  const char* summary;       ///< line of `palpate --help`
  const char* program;       ///< "palpate-bench"
  const char* absent;        ///< why the file may not exist, and how to get it
  bool has_commands = true;  ///< its command line begins with the command
};

/// Meshing, in a separate program: palpate neither links nor loads CGAL and Gmsh.
inline constexpr OtherProgram kModel = {
    "model", "a layered model of a closed surface: tetrahedra, skin, proxies", "palpate-model",
    "this build makes no models; configure with -DPALPATE_WITH_MODEL=ON (packages libcgal-dev, "
    "libgmsh-dev) and build the target palpate-model",
    false};
inline constexpr OtherProgram kBench = {
    "bench", "how long things take on this machine", "palpate-bench",
    "the packages do not include it; `./palpate bench` in a clone of the sources builds it"};

/// Returns the program that runs a command; null if palpate runs it.
const OtherProgram* find_other_program(std::string_view command);

/// Returns the path of the program.  @throws Error if the file does not exist
std::string path_of(const OtherProgram& other);

/// Replaces this process by the program, with the command and these arguments; returns only by throwing.
/// @throws Error if the program's file does not exist
int start(const OtherProgram& other, const std::vector<std::string>& arguments);

}  // namespace palpate::cli
