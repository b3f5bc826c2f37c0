#include "cli/program.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <sstream>

#include "cli/guarded.h"
#include "cli/help_formatter.h"
#include "cli/stop.h"
#include "cli/streams.h"
#include "core/process_pool.h"
#include "palpate/core/error.h"
#include "palpate/core/log.h"
#include "store/provenance.h"
#include "tune.h"

namespace palpate::cli {
namespace {

/// Returns the message for words that no option and no positional takes: the first unknown option, with the
/// nearest known one, or else the first word.
std::string message_of_extras(const CLI::App& app) {
  const std::vector<std::string> extras = app.remaining(true);
  const auto option = std::find_if(extras.begin(), extras.end(),
                                   [](const std::string& word) { return word.starts_with("-"); });
  if (option == extras.end())
    return fmt::format("\"{}\" is one argument too many", extras.empty() ? "" : extras.front());
  const std::string name = option->substr(0, option->find('='));
  std::vector<std::string> known;
  for (const CLI::App* used : app.get_subcommands())
    for (const CLI::Option* one : used->get_options())
      for (const std::string& word : one->get_lnames()) known.push_back("--" + word);
  const std::string nearest = suggestion(name, known);
  return fmt::format("there is no option {}{}", name, nearest.starts_with(" (did") ? nearest : "");
}

/// Throws an error for an invalid command line and refers to the help of the command: the messages of CLI11
/// name the option.
void refuse(const CLI::App& app, const CLI::ParseError& error, int argc, char** argv) {
  std::string command = "palpate", message = error.what();
  for (const CLI::App* used : app.get_subcommands()) command += " " + used->get_name();
  if (dynamic_cast<const CLI::ExtrasError*>(&error)) message = message_of_extras(app);
  const std::vector<std::string> words(argv + 1, argv + argc);
  const auto first = std::find_if(words.begin(), words.end(),
                                  [](const std::string& word) { return !word.starts_with("-"); });
  if (app.get_subcommands().empty() && first != words.end()) {
    std::vector<std::string> known;
    for (const CLI::App* one : app.get_subcommands({})) known.push_back(one->get_name());
    message = fmt::format("there is no command \"{}\"{}", *first, suggestion(*first, known));
  }
  fail("{}; see `{} --help`", message, command);
}

int run_guarded(const std::function<int()>& action) { return guarded(action, "scene"); }

int run_action(const Invocation& invocation) {
  const int status = invocation.action();
  return stop_flag() && status == 0 ? kExitStopped : status;
}

}  // namespace

Invocation parse_line(int argc, char** argv, const CommandLine& line) {
  Invocation invocation;
  invocation.words.assign(argv + 1, argv + argc);
  CLI::App app(line.description, "palpate");
  app.set_version_flag("--version", [] {
    const store::Provenance made_by = store::provenance();
    return fmt::format("palpate {} (commit {}, {}, {})", made_by.version, made_by.commit, made_by.compiler,
                       made_by.build_type);
  });
  app.formatter(std::make_shared<HelpFormatter>());
  app.add_flag("-q,--quiet", invocation.quiet, "only errors");
  app.add_flag("-v,--verbose", invocation.verbose, "also details");
  app.footer(line.examples);
  app.require_subcommand(1);
  app.fallthrough();
  line.add_commands(app, invocation);
  if (argc == 1) {
    fmt::print("{}", app.help());
    return {};
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked) {  // --help, --version
    std::ostringstream text;
    app.exit(asked, text, text);
    fmt::print("{}", text.str());
    return {};
  } catch (const CLI::ParseError& error) { refuse(app, error, argc, argv); }
  return invocation;
}

int run_program(int argc, char** argv, Invocation (*parse)(int argc, char** argv)) {
  end_where_loading_is_tried();
  log::configure(false, false);  // uses standard error unguarded, for its colours
  guard_streams();
  Invocation invocation;
  const int parsed = run_guarded([&] {
    invocation = parse(argc, argv);
    return 0;
  });
  if (!invocation.action) return parsed;
  if (invocation.factorises) restart_tuned(argv);
  if (invocation.starts_processes) {
    const int prepared = run_guarded([] {
      ProcessPool::prepare();
      return 0;
    });
    if (prepared != 0) return prepared;
  }
  log::configure(invocation.quiet, invocation.verbose);
  catch_stop_signals();
  return run_guarded([&] { return run_action(invocation); });
}

}  // namespace palpate::cli
