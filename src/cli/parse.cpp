// The command line, and the help that teaches it.
#include "parse.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <vector>

#include "cli/other_program.h"
#include "commands.h"

namespace palpate::cli {
namespace {

constexpr const char* kDescription =
    "palpate renders touch: a hand moves a haptic handle, a virtual spring pulls a rigid tool after it, the "
    "tool presses into a soft body,\n"
    "and the force returns to the hand.  Every result comes with its error and its cost in run time.";

constexpr const char* kExamples = R"(Examples:
  palpate demo                                   an overview in a minute; open out/demo/report.html
  palpate run press-ball                         a tool presses a soft ball; results in out/press-ball
  palpate run my.toml --set body.0.youngs_modulus_pa=2e4 -o out/softer
  palpate touch                                  touch a head in your browser, in real time
  palpate new liver.obj --unit mm                a scene that touches your mesh, each number explained
  palpate inspect press-ball                     sizes, masses and gaps of a scene before it runs
  palpate export out/press-ball --to vtu         a run as files for other programs
  palpate model liver.obj -o liver.h5            a layered model of a closed surface
  palpate compare cantilever                     error against run time, for every integrator
  palpate validate                               all cases with a known answer
  palpate list integrators                       names accepted in scenes and by --integrator

`palpate COMMAND --help` describes a command, `palpate help` prints the documentation.

Exit status: 0 on success; 1 on an error; 3 if part of the output is missing, which the last line lists; 130
after Ctrl-C.)";

/// Line of `palpate --help` about a command of another program, which parses its arguments.
void add_other(CLI::App& app, const OtherProgram& other) {
  app.add_subcommand(std::string(other.command), other.summary);
}

void add_commands(CLI::App& app, Invocation& invocation) {
  add_demo(app, invocation);
  add_new(app, invocation);
  add_run(app, invocation);
  add_other(app, kTouch);
  add_compare(app, invocation);
  add_study(app, invocation);
  add_other(app, kValidate);
  add_modes(app, invocation);
  add_other(app, kModel);
  add_stability(app, invocation);
  add_resume(app, invocation);
  add_replay(app, invocation);
  add_movie(app, invocation);
  add_export(app, invocation);
  add_diff(app, invocation);
  add_report(app, invocation);
  add_inspect(app, invocation);
  add_list(app, invocation);
  add_help(app, invocation);
  add_other(app, kBench);
}

}  // namespace

Invocation parse(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  const auto command = std::find_if(words.begin(), words.end(),
                                    [](const std::string& word) { return !word.starts_with("-"); });
  const OtherProgram* other = command == words.end() ? nullptr : find_other_program(*command);
  if (!other) return parse_line(argc, argv, {kDescription, kExamples, add_commands});
  Invocation invocation;  // every word, --help too, is for that program
  invocation.action = [other, words] { return start(*other, words); };
  return invocation;
}

}  // namespace palpate::cli
