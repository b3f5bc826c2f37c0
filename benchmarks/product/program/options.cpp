#include "options.h"

#include <CLI/CLI.hpp>
#include <memory>

#include "cli/other_program.h"

namespace palpate::cli {
namespace {

void add_bench(CLI::App& app, Invocation& invocation) {
  CLI::App* command = app.add_subcommand(std::string(kBench.command), kBench.summary);
  auto arguments = std::make_shared<BenchArguments>();
  command
      ->add_option("WHAT", arguments->what,
                   "fem: one implicit step of a soft beam at several sizes, split into its stages; "
                   "contact: one exchange period of the paper's scenes, split into its stages; continuity: "
                   "how much the contact force jumps along random paths; leave-out: what absent and present "
                   "parts cost")
      ->required();
  command->add_option("SCENE", arguments->scenes,
                      "of leave-out; default falling-ball and cantilever; of contact and continuity; default "
                      "those of the paper");
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
          "contact, continuity: distance, image; default of contact distance and, where OpenGL opens, "
          "image; of continuity distance")
      ->type_name("NAME")
      ->delimiter(',')
      ->check(CLI::IsMember({"distance", "image"}));
  command->add_flag("--all", arguments->all, "contact: each stage with its least time and 99th percentile");
  command->add_flag("--growth", arguments->growth,
                    "contact: how a query grows with the skin's vertices and the region's area instead");
  command->add_flag("--check", arguments->check,
                    "contact: compare what was measured with its bars; with no scene named the growth, too");
  command->add_option("--linear-rtol", arguments->linear_rtols, "fem: tolerances; default 1e-6,1e-3")
      ->delimiter(',')
      ->check(CLI::PositiveNumber);
  command->add_option("--youngs-modulus-pa", arguments->youngs_moduli_pa, "fem: default 1e5,1e6")
      ->delimiter(',')
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--steps", arguments->steps,
                   "fem: steps of 10 ms that are timed; of 1 ms ten times as many, the same motion")
      ->check(CLI::Range(3, 1000000))
      ->capture_default_str();
  command->add_option("--linear-solver", arguments->linear_solvers, "fem: see `palpate list linear-solvers`")
      ->type_name("NAME")
      ->delimiter(',')
      ->capture_default_str();
  command->add_flag("--accuracy", arguments->accuracy,
                    "fem: error against run time of one motion instead of the stages of a step");
  command
      ->add_option("-o,--output", arguments->folder,
                   "fem: folder for bench-fem.json and bench-fem.svg; contact: for bench-contact.json")
      ->type_name("DIR");
  command->add_option("--cells", arguments->cells, "fem: one beam of so many cells along, by way of a scene")
      ->check(CLI::Range(4, 1000));
  command->add_option("--step-s", arguments->step_s, "fem with --cells: the step [s]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--repeats", arguments->repeats, "leave-out: runs of each variant")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--paths", arguments->paths, "continuity: random paths of a scene")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command->add_option("--path-steps", arguments->path_steps, "continuity: steps of a path")
      ->check(CLI::Range(10, 6400))
      ->capture_default_str();
  command
      ->add_option("--quadrature-error", arguments->quadrature_error,
                   "continuity: what nearest points may err in the force")
      ->check(CLI::Range(1e-6, 0.1))
      ->capture_default_str();
  command->footer(R"(Examples:
  palpate bench fem                              3,700 and 11,172 nodes, steps of 10 and 1 ms
  palpate bench fem --size S,M,L --threads 1 -o out/bench
  palpate bench fem --accuracy -o out/bench
  palpate bench fem --cells 16 --step-s 0.001
  palpate bench contact                          the paper's pairs: stages, and contact beside a step
  palpate bench contact touch-head --method distance,image
  palpate bench contact --growth                 skins of 10,000 to 1,000,000 vertices
  palpate bench contact --check -o out/bench     is each figure what it must be?
  palpate bench continuity gears --paths 100
  palpate bench leave-out falling-ball --repeats 9

Exit status with contact --check: 0 when every figure keeps its bar, else 1.)");
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
