#pragma once
#include <functional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

/// Code that palpate and the programs started by it (other_program.h) share.
namespace palpate::cli {

/// Parsed command line.
struct Invocation {
  std::function<int()> action;    ///< Empty if help was requested and printed
  bool factorises = false;        ///< Restarts with tuned linear algebra, since it factorises
  bool starts_processes = false;  ///< Prepares core's ProcessPool before any file is opened
  bool quiet = false, verbose = false;
  std::vector<std::string> words{};  ///< Words of the command line, without the program's name
};

/// Description of a program's command line.
struct CommandLine {
  const char* description;
  const char* examples;  ///< Printed at the end of the help
  void (*add_commands)(CLI::App& app, Invocation& invocation);
};

/// Parses the command line of a program with several commands; prints help or version if requested.
/// @throws Error for an invalid line
Invocation parse_line(int argc, char** argv, const CommandLine& line);

/// Body of main() of a program: parses the line, prepares the process for the action, and runs it.
/// @return the exit status
int run_program(int argc, char** argv, Invocation (*parse)(int argc, char** argv));

}  // namespace palpate::cli
