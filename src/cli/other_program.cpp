#include "palpate/cli/other_program.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "palpate/core/error.h"
#include "palpate/core/program.h"

namespace palpate::cli {
namespace fs = std::filesystem;

const OtherProgram* find_other_program(std::string_view command) {
  for (const OtherProgram* other : {&kModel, &kBench})
    if (other->command == command) return other;
  return nullptr;
}

std::string path_of(const OtherProgram& other) {
  const fs::path program = fs::path(program_path()).parent_path() / other.program;
  if (!fs::exists(program)) fail("{}: {} is not there: {}", other.command, program.string(), other.absent);
  return program.string();
}

int start(const OtherProgram& other, const std::vector<std::string>& arguments) {
  const std::string program = path_of(other), command(other.command);
  std::vector<std::string> words = {"palpate"};
  if (other.has_commands)
    words.push_back(command);
  else
    words.front() += " " + command;
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  ::execv(program.c_str(), pointers.data());
  fail("{}: {} cannot be started: {}", command, program, std::strerror(errno));
}

}  // namespace palpate::cli
