#include "size_question.h"

#include <fmt/format.h>
#include <unistd.h>

#include <iostream>

#include "mesh/size_check.h"
#include "palpate/core/error.h"

namespace palpate::cli {

void ask_about_size(const ModelArguments& arguments, const model::Input& input) {
  const Points& points = input.tets.nodes.cols() > 0 ? input.tets.nodes : input.surface.vertices;
  const std::optional<mesh::SizeDoubt> doubt = mesh::doubt_about_size(points);
  if (arguments.scaled || !doubt) return;
  const std::string units = fmt::format("for a file in {}, use --scale {}{}", doubt->other_unit,
                                        doubt->factor, doubt->factor == 1e-3 ? " or --unit mm" : ""),
                    question = fmt::format("{}: the body is {:.3g} m large: is this intended?", input.source,
                                           doubt->size_m);
  if (::isatty(STDIN_FILENO) == 1 && ::isatty(STDERR_FILENO) == 1) {
    fmt::print(stderr, "palpate: {} [y/N] ", question);
    std::string answer;
    std::getline(std::cin, answer);
    if (answer == "y" || answer == "Y" || answer == "yes") return;
    fail("{}: not made; --scale multiplies the coordinates: {}", input.source, units);
  }
  fail("{} If so, use --scale 1; {}", question, units);
}

}  // namespace palpate::cli
