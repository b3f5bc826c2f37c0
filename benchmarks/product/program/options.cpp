#include "options.h"

#include <CLI/CLI.hpp>
#include <memory>

#include "cli/other_program.h"

namespace palpate::cli {
namespace {

constexpr const char* kExamples = R"(Examples:
  palpate bench fem                              3,700 and 11,172 nodes, steps of 10 and 1 ms
  palpate bench fem --size S,M,L --threads 1 -o out/bench
  palpate bench fem --accuracy -o out/bench
  palpate bench fem --cells 16 --step-s 0.001
  palpate bench contact                          the paper's pairs: stages, and cost relative to a step
  palpate bench contact touch-head --method distance,image
  palpate bench contact --growth                 skins of 10,000 to 1,000,000 vertices
  palpate bench contact --check -o out/bench     compares the figures with their limits
  palpate bench continuity gears --paths 100
  palpate bench leave-out falling-ball --repeats 9

Exit status with contact --check: 0 if every figure meets its acceptance limit, else 1.)";

/// Adds the options of `bench leave-out` and `bench continuity`.
void add_repetitions(CLI::App& command, BenchArguments& arguments) {
  command.add_option("--repeats", arguments.repeats, "leave-out: number of runs of each variant")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command.add_option("--paths", arguments.paths, "continuity: number of random paths per scene")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command.add_option("--path-steps", arguments.path_steps, "continuity: number of steps per path")
      ->check(CLI::Range(10, 6400))
      ->capture_default_str();
  command
      .add_option("--quadrature-error", arguments.quadrature_error,
                  "continuity: tolerance of the quadrature error of nearest points, relative to the force")
      ->check(CLI::Range(1e-6, 0.1))
      ->capture_default_str();
}

void add_bench(CLI::App& app, Invocation& invocation) {
  CLI::App* command = app.add_subcommand(std::string(kBench.command), kBench.summary);
  auto arguments = std::make_shared<BenchArguments>();
  command
      ->add_option("WHAT", arguments->what,
                   "fem: stages of one implicit step of a soft beam of several sizes; contact: stages of one "
                   "exchange period of the paper's scenes; continuity: jumps of the contact force along "
                   "random paths; leave-out: overhead of absent and present parts")
      ->required();
  command->add_option("SCENE", arguments->scenes,
                      "leave-out: default falling-ball and cantilever; contact, continuity: default the "
                      "scenes of the paper");
  command
      ->add_option("--size", arguments->sizes,
                   "fem: XS, S, M, L, XL (1,425 to 100,000 nodes); default S and M")
      ->delimiter(',');
  command->add_option("--threads", arguments->threads, "fem, contact: numbers of threads; default 1,2")
      ->delimiter(',')
      ->check(CLI::Range(1, 64));
  command
      ->add_option(
          "--method", arguments->methods,
          "contact, continuity: distance, image; default for contact: distance and, if OpenGL is available, "
          "image; for continuity: distance")
      ->type_name("NAME")
      ->delimiter(',')
      ->check(CLI::IsMember({"distance", "image"}));
  command->add_flag("--all", arguments->all, "contact: minimum, median and 99th percentile of each stage");
  command->add_flag("--growth", arguments->growth,
                    "contact: instead, growth of the query time with the number of skin vertices and the "
                    "area of the region");
  command->add_flag("--check", arguments->check,
                    "contact: compare the measured figures with their acceptance limits; without SCENE also "
                    "the growth");
  command->add_option("--linear-rtol", arguments->linear_rtols, "fem: tolerances; default 1e-6,1e-3")
      ->delimiter(',')
      ->check(CLI::PositiveNumber);
  command->add_option("--youngs-modulus-pa", arguments->youngs_moduli_pa, "fem: default 1e5,1e6")
      ->delimiter(',')
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--steps", arguments->steps,
                   "fem: number of timed steps of 10 ms; ten times as many of 1 ms for the same motion")
      ->check(CLI::Range(3, 1000000))
      ->capture_default_str();
  command->add_option("--linear-solver", arguments->linear_solvers, "fem: see `palpate list linear-solvers`")
      ->type_name("NAME")
      ->delimiter(',')
      ->capture_default_str();
  command->add_flag("--accuracy", arguments->accuracy, "fem: instead, error against run time of one motion");
  command
      ->add_option("-o,--output", arguments->folder,
                   "fem: folder for bench-fem.json; contact: for bench-contact.json")
      ->type_name("DIR");
  command
      ->add_option("--cells", arguments->cells,
                   "fem: one beam with this number of cells along its length, built by a scene")
      ->check(CLI::Range(4, 1000));
  command->add_option("--step-s", arguments->step_s, "fem with --cells: the step [s]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  add_repetitions(*command, *arguments);
  command->footer(kExamples);
  command->callback([arguments, &invocation] {
    invocation.action = [arguments] { return bench(*arguments); };
    invocation.factorises = true;
  });
}

}  // namespace

Invocation parse_bench(int argc, char** argv) {
  return parse_line(argc, argv, {"palpate-bench: the program behind `palpate bench`.", "", add_bench});
}

}  // namespace palpate::cli
