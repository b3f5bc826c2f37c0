#include "size_question.h"

#include <fmt/format.h>
#include <unistd.h>

#include <iostream>

#include "palpate/core/error.h"

namespace palpate::cli {
namespace {

constexpr double kLargest = 10.0, kSmallest = 1e-3;  // [m]

}  // namespace

void ask_about_size(const ModelArguments& arguments, const model::Input& input) {
  const Points& points = input.tets.nodes.cols() > 0 ? input.tets.nodes : input.surface.vertices;
  if (arguments.scaled || points.cols() == 0 || !points.allFinite()) return;
  const double size = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).maxCoeff();
  if (size <= kLargest && size >= kSmallest) return;
  const char* const units = size > kLargest ? "a file in millimetres takes --scale 0.001"
                                            : "a file in kilometres takes --scale 1000";
  const std::string question =
      fmt::format("{}: the body is {:.3g} m large: is that meant?", input.source, size);
  if (::isatty(STDIN_FILENO) == 1 && ::isatty(STDERR_FILENO) == 1) {
    fmt::print(stderr, "palpate: {} [y/N] ", question);
    std::string answer;
    std::getline(std::cin, answer);
    if (answer == "y" || answer == "Y" || answer == "yes") return;
    fail("{}: not made; --scale multiplies the coordinates: {}", input.source, units);
  }
  fail("{} Then say --scale 1; {}", question, units);
}

}  // namespace palpate::cli
