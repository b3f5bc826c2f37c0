#pragma once

namespace CLI {
class App;
}

/// The commands of palpate, in the order of its help.  Each add_NAME() declares a command: its arguments,
/// options, help and action.  It is defined in NAME.cpp, which also executes the command; where both together
/// would be long, in NAME_options.cpp.
namespace palpate::cli {

struct Invocation;

void add_demo(CLI::App& app, Invocation& invocation);
void add_new(CLI::App& app, Invocation& invocation);
void add_run(CLI::App& app, Invocation& invocation);
void add_compare(CLI::App& app, Invocation& invocation);
void add_study(CLI::App& app, Invocation& invocation);
void add_modes(CLI::App& app, Invocation& invocation);
void add_stability(CLI::App& app, Invocation& invocation);
void add_resume(CLI::App& app, Invocation& invocation);
void add_replay(CLI::App& app, Invocation& invocation);
void add_movie(CLI::App& app, Invocation& invocation);
void add_export(CLI::App& app, Invocation& invocation);
void add_diff(CLI::App& app, Invocation& invocation);
void add_report(CLI::App& app, Invocation& invocation);
void add_inspect(CLI::App& app, Invocation& invocation);
void add_list(CLI::App& app, Invocation& invocation);
void add_help(CLI::App& app, Invocation& invocation);

}  // namespace palpate::cli
