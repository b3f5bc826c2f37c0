#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <new>

#include "options.h"
#include "outcome.h"
#include "palpate/core/error.h"
#include "palpate/core/log.h"
#include "pictures.h"
#include "progress.h"
#include "sources.h"
#include "stop.h"

namespace palpate::cli {
namespace {

/// A bar a step.
class Bars : public model::Watcher {
 public:
  explicit Bars(bool verbose) : verbose_(verbose) {}
  void begin(const std::string& step) override { bar_ = std::make_unique<Progress>(step); }
  void progress(double fraction) override { (*bar_)(fraction); }
  void end(const model::Step& step) override {
    bar_.reset();
    if (verbose_) fmt::print(stderr, "palpate: {}: {:.2f} s\n", step.name, step.seconds);
  }

 private:
  bool verbose_;
  std::unique_ptr<Progress> bar_;
};

int model_command(int argc, char** argv) {
  ModelArguments arguments = parse_model(argc, argv);
  if (!arguments.given) return 0;
  log::configure(arguments.quiet, arguments.verbose);
  if (!arguments.picture.empty()) check_pictures(arguments.picture);
  model::Input input = input_of(arguments);
  if (arguments.output.empty()) arguments.output = input.name + ".h5";
  if (std::error_code none; std::filesystem::equivalent(arguments.source, arguments.output, none))
    fail("-o {}: is the source itself; choose another name", arguments.output);
  Bars bars(arguments.verbose);
  model::Made made = model::make_model(std::move(input), arguments.options, bars);
  made.file.record.options = arguments.as_given;
  store::write_model(arguments.output, made.file);
  if (!arguments.picture.empty()) draw_model(made.file.model, arguments.picture);
  if (!arguments.quiet) print_outcome(made, arguments.output);
  return 0;
}

}  // namespace
}  // namespace palpate::cli

int main(int argc, char** argv) {
  using namespace palpate;
  try {
    return cli::model_command(argc, argv);
  } catch (const Error& e) {
    fmt::print(stderr, "palpate: error: {}\n", e.what());
    return cli::kExitError;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "palpate: error: not enough memory; fewer tetrahedra need less\n");
    return cli::kExitError;
  } catch (const std::exception& e) {
    fmt::print(stderr,
               "palpate: internal error: {}\nThis is a mistake in palpate, not in your input: please report "
               "it with the surface and this message.\n",
               e.what());
    return cli::kExitInternalError;
  }
}
