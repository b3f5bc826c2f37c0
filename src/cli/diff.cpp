#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>

#include "cli/paths.h"
#include "cli/program.h"
#include "commands.h"
#include "experiments/compare/perceptible_difference.h"
#include "loop/haptic_record.h"
#include "palpate/loop/load.h"
#include "palpate/scene/hands.h"

namespace palpate::cli {
namespace {

struct DiffArguments {
  std::string reference, other;  ///< Folders of runs
};

/// Returns the further hands of the scene of a run. The files in the folder are no substitute: an earlier run
/// may have left files of other hands.
std::vector<std::string> more_hands(const std::filesystem::path& folder) {
  const std::filesystem::path scene = folder / "scene.toml";
  std::vector<std::string> out;
  if (!std::filesystem::exists(scene)) return out;
  for (const scene::HandSpec& hand : loop::parse(read_text(scene.string()), scene.string()).hands)
    out.push_back(hand.name);
  return out;
}

int diff(const DiffArguments& arguments) {
  const std::filesystem::path reference(arguments.reference), other(arguments.other);
  const auto difference = [&](const std::string& name) {
    const auto ticks = [&](const std::filesystem::path& folder) {
      return loop::read_haptic_record((folder / name).string()).ticks;
    };
    return compare::text_of(compare::perceptible_difference(ticks(reference), ticks(other)));
  };
  const std::string first = difference("haptic.h5");
  const std::vector<std::string> mine = more_hands(reference), theirs = more_hands(other);
  const auto has = [](const std::vector<std::string>& hands, const std::string& name) {
    return std::find(hands.begin(), hands.end(), name) != hands.end();
  };
  fmt::print("{}{}", mine.empty() && theirs.empty() ? "" : "tool:\n", first);
  for (const std::string& hand : mine) {
    if (has(theirs, hand))
      fmt::print("{}:\n{}", hand, difference(fmt::format("haptic-{}.h5", hand)));
    else
      fmt::print("{}: not present in {}\n", hand, other.string());
  }
  for (const std::string& hand : theirs)
    if (!has(mine, hand)) fmt::print("{}: not present in {}\n", hand, reference.string());
  return 0;
}

}  // namespace

void add_diff(CLI::App& app, Invocation& invocation) {
  CLI::App* command = app.add_subcommand("diff", "measure the perceptible difference of two runs");
  auto arguments = std::make_shared<DiffArguments>();
  command->add_option("reference", arguments->reference, "folder of a run, which contains haptic.h5")
      ->required()
      ->type_name("DIR");
  command->add_option("other", arguments->other, "folder of another run")->required()->type_name("DIR");
  command->footer(R"(Examples:
  palpate diff out/press-ball out/replay-press-ball

Prints for force and torque on the hand, at the reference's ticks: RMS and largest difference, its spectrum in
bands, and the share of ticks above the perception threshold of fingers (7 % of a force, 12.7 % of a
torque).)");
  command->callback(
      [arguments, &invocation] { invocation.action = [arguments] { return diff(*arguments); }; });
}

}  // namespace palpate::cli
