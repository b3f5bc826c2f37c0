// `palpate help`: prints the pages of docs/ embedded in the program.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "cli/other_program.h"
#include "cli/program.h"
#include "commands.h"
#include "help_pages.h"
#include "help_topic.h"
#include "palpate/core/error.h"
#include "plain_text.h"
#include "report/table.h"

namespace palpate::cli {
namespace {

struct HelpArguments {
  std::string topic;                  ///< Page; empty: prints the list of pages
  bool markdown = false;              ///< Prints the page as Markdown
  std::vector<std::string> commands;  ///< Names of commands, to suggest for an unknown topic
};

/// Returns the text width: the width of the terminal, at most 100 columns, since longer lines are hard to
/// read.
std::size_t text_width() {
  constexpr std::size_t kMost = 100, kLeast = 40;
  ::winsize size{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return kMost;
  return std::clamp<std::size_t>(size.ws_col, kLeast, kMost);
}

void print_topics() {
  std::vector<std::vector<std::string>> rows;
  for (const HelpPage& page : help_pages())
    rows.push_back({std::string(page.topic), title_of(std::string(page.markdown))});
  fmt::print(
      "{}\n`palpate help TOPIC` prints one of these pages; `palpate COMMAND --help` prints the options of a "
      "command.\n",
      report::format_table({"topic", "content"}, rows));
}

int help(const HelpArguments& arguments) {
  if (arguments.topic.empty()) {
    print_topics();
    return 0;
  }
  std::vector<std::string> known;
  for (const HelpPage& page : help_pages()) {
    known.emplace_back(page.topic);
    if (page.topic != arguments.topic) continue;
    const std::string markdown(page.markdown);
    fmt::print("{}", arguments.markdown ? markdown : plain_text(markdown, text_width()));
    return 0;
  }
  std::vector<std::string> candidates = known;
  candidates.insert(candidates.end(), arguments.commands.begin(), arguments.commands.end());
  const std::vector<std::string> begin = beginning_with(arguments.topic, candidates);
  if (begin.size() > 1)
    fail("\"{}\" is the beginning of {}; write more of it", arguments.topic, fmt::join(begin, ", "));
  const std::string near = nearest_name(arguments.topic, candidates);
  fail("there is no help topic \"{}\"{}; topics: {}", arguments.topic,
       near.empty() ? "" : fmt::format(" (did you mean \"{}\"?)", near), fmt::join(known, ", "));
}

}  // namespace

void add_help(CLI::App& app, Invocation& invocation) {
  CLI::App* command = app.add_subcommand("help", "print a page of the documentation");
  auto arguments = std::make_shared<HelpArguments>();
  command->add_option("TOPIC", arguments->topic,
                      "page, or command whose options to print; default: the list of pages");
  command->add_flag("--markdown", arguments->markdown,
                    "print the page as Markdown, not formatted for the terminal");
  command->footer(R"(Examples:
  palpate help
  palpate help first-touch
  palpate help keys)");
  command->callback([arguments, &app, &invocation] {
    for (const CLI::App* one : app.get_subcommands({})) arguments->commands.push_back(one->get_name());
    std::vector<std::string> topics;
    for (const HelpPage& page : help_pages()) topics.emplace_back(page.topic);
    const bool is_topic = complete_topic(topics, arguments->commands, arguments->topic);
    const bool is_command =
        !is_topic && std::count(arguments->commands.begin(), arguments->commands.end(), arguments->topic) > 0;
    if (const OtherProgram* other = find_other_program(arguments->topic)) {
      invocation.action = [other, topic = arguments->topic] { return start(*other, {topic, "--help"}); };
      return;
    }
    if (is_command) {
      const std::string text = app.get_subcommand(arguments->topic)->help(app.get_name());
      invocation.action = [text] {
        fmt::print("{}", text);
        return 0;
      };
      return;
    }
    invocation.action = [arguments] { return help(*arguments); };
  });
}

}  // namespace palpate::cli
