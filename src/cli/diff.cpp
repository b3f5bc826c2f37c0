#include <fmt/format.h>

#include <filesystem>

#include "commands.h"
#include "palpate/compare/felt_difference.h"
#include "palpate/loop/haptic_record.h"

namespace palpate::cli {

int diff(const DiffArguments& arguments) {
  const auto ticks = [](const std::string& folder) {
    return loop::read_haptic_record((std::filesystem::path(folder) / "haptic.h5").string()).ticks;
  };
  fmt::print("{}",
             compare::text_of(compare::felt_difference(ticks(arguments.reference), ticks(arguments.other))));
  return 0;
}

}  // namespace palpate::cli
