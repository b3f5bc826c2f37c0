#pragma once
#include <functional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

/// Code that palpate and the programs that it starts (other_program.h) share.
namespace palpate::cli {

/// The parsed command line.
struct Invocation {
  std::function<int()> action;    ///< empty: help was asked for and given
  bool factorises = false;        ///< worth restarting with tuned linear algebra
  bool starts_processes = false;  ///< core's ProcessPool is made ready before anything is opened
  bool quiet = false, verbose = false;
  std::vector<std::string> words{};  ///< of the line, without the program's name
};

/// Description of a program's command line.
struct CommandLine {
  const char* description;
  const char* examples;  ///< printed at the end of its help
  void (*add_commands)(CLI::App& app, Invocation& invocation);
};

/// Parses the command line of a program with several commands; prints help or version if requested.
/// @throws Error for an invalid line
Invocation parse_line(int argc, char** argv, const CommandLine& line);

/// The body of a program's main(): parses the line, prepares what the action needs, and runs it.
/// @return the exit status
int run_program(int argc, char** argv, Invocation (*parse)(int argc, char** argv));

}  // namespace palpate::cli
