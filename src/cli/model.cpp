#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <vector>

#include "commands.h"
#include "palpate/core/error.h"

// Meshing is a program of its own: this one, which renders touch, neither links nor loads CGAL and Gmsh.
namespace palpate::cli {

int model(const std::vector<std::string>& arguments) {
  const std::filesystem::path program =
      std::filesystem::canonical("/proc/self/exe").parent_path() / "palpate-model";
  if (!std::filesystem::exists(program))
    fail(
        "model: {} is not there: this build makes no models; configure with -DPALPATE_WITH_MODEL=ON "
        "(packages libcgal-dev, libgmsh-dev) and build the target palpate-model",
        program.string());
  std::vector<std::string> words = {"palpate model"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  ::execv(program.c_str(), pointers.data());
  fail("model: {} cannot be started: {}", program.string(), std::strerror(errno));
}

}  // namespace palpate::cli
