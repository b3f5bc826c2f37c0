#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <vector>

#include "commands.h"
#include "model_cache.h"
#include "palpate/core/error.h"

// Meshing is a program of its own: this one, which renders touch, neither links nor loads CGAL and Gmsh.
namespace palpate::cli {

int model(const std::vector<std::string>& arguments) {
  const std::string program = model_program();
  std::vector<std::string> words = {"palpate model"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  ::execv(program.c_str(), pointers.data());
  fail("model: {} cannot be started: {}", program, std::strerror(errno));
}

}  // namespace palpate::cli
