#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace palpate::cli {

/// Command that another program runs, installed in the same folder.
struct OtherProgram {
  std::string_view command;  ///< Name of the command: "bench"
  const char* summary;       ///< Line of `palpate --help`
  const char* program;       ///< File name of the program: "palpate-bench"
  const char* absent;        ///< Why the file may not exist, and how to get it
  bool has_commands = true;  ///< Whether the command line of the program begins with the command
};

/// Meshing, in a separate program: palpate neither links nor loads CGAL and Gmsh.
inline constexpr OtherProgram kModel = {
    "model", "make a layered model of a closed surface: tetrahedra, skin, proxies", "palpate-model",
    "this build makes no models; configure with -DPALPATE_WITH_MODEL=ON (packages libcgal-dev, "
    "libgmsh-dev) and build the target palpate-model",
    false};
/// Server of the page of a scene, in a separate program: palpate does not load libwebsockets.
inline constexpr OtherProgram kTouch = {
    "touch", "touch a scene in a browser, in real time", "palpate-touch",
    "this build has no server; configure with -DPALPATE_WITH_LIVE=ON (package libwebsockets-dev) and build "
    "the target palpate-touch"};
inline constexpr OtherProgram kBench = {
    "bench", "benchmarks on this machine", "palpate-bench",
    "the packages do not include it; `./palpate bench` in a clone of the sources builds it"};
inline constexpr OtherProgram kValidate = {"validate", "run the cases with a known answer",
                                           "palpate-validation", "build the target palpate-validation"};
inline constexpr OtherProgram kStability = {
    "stability", "run stiff and extreme cases with every integrator and compare each with theory",
    kValidate.program, kValidate.absent};  ///< Stability matrix; `--haptic` runs in palpate
inline constexpr OtherProgram kCases = {"cases", "the cases with a known answer, for `palpate list`",
                                        kValidate.program, kValidate.absent};

/// Returns the program that runs a command; null if palpate runs the command, or selects the program by its
/// options.
const OtherProgram* find_other_program(std::string_view command);

/// Returns the path of the program.  @throws Error if the file does not exist
std::string path_of(const OtherProgram& other);

/// Returns whether the program's file exists.
bool is_there(const OtherProgram& other);

/// Replaces this process by the program; returns only by throwing.
/// @param words  words of the command line, including the command
/// @throws Error if the program's file does not exist
int start(const OtherProgram& other, std::vector<std::string> words);

/// Runs the command without arguments, and returns its standard output.
/// @throws Error if the program's file does not exist, or the program fails
std::string output_of(const OtherProgram& other);

/// Runs the program to its end, and discards its standard output; errors and progress are printed.
/// @param words  arguments
/// @param folder  working folder; empty: that of the caller
/// @return its exit status, nonzero too where a signal ended it
/// @throws Error if the program's file does not exist
int run_silently(const OtherProgram& other, const std::vector<std::string>& words,
                 const std::string& folder = {});

}  // namespace palpate::cli
