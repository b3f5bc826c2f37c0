#include <fmt/format.h>

#include <filesystem>
#include <set>

#include "commands.h"
#include "palpate/compare/felt_difference.h"
#include "palpate/loop/haptic_record.h"

namespace palpate::cli {
namespace {

/// Of the further hands of a run, by the names of their records: haptic-NAME.h5.
std::set<std::string> more_hands(const std::filesystem::path& folder) {
  std::set<std::string> out;
  for (const auto& file : std::filesystem::directory_iterator(folder)) {
    const std::string name = file.path().filename().string();
    if (name.starts_with("haptic-") && name.ends_with(".h5")) out.insert(name);
  }
  return out;
}

}  // namespace

int diff(const DiffArguments& arguments) {
  const std::filesystem::path reference(arguments.reference), other(arguments.other);
  const auto difference = [&](const std::string& name) {
    const auto ticks = [&](const std::filesystem::path& folder) {
      return loop::read_haptic_record((folder / name).string()).ticks;
    };
    return compare::text_of(compare::felt_difference(ticks(reference), ticks(other)));
  };
  const std::string first = difference("haptic.h5");
  const std::set<std::string> mine = more_hands(reference), theirs = more_hands(other);
  std::set<std::string> all = mine;
  all.insert(theirs.begin(), theirs.end());
  fmt::print("{}{}", all.empty() ? "" : "tool:\n", first);
  for (const std::string& name : all) {
    const std::string hand = name.substr(7, name.size() - 10);
    if (mine.contains(name) && theirs.contains(name))
      fmt::print("{}:\n{}", hand, difference(name));
    else
      fmt::print("{}: there is none in {}\n", hand, (mine.contains(name) ? other : reference).string());
  }
  return 0;
}

}  // namespace palpate::cli
