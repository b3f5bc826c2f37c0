#include "experiments/compare/mesh.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "experiments/compare/cells.h"
#include "experiments/compare/mesh_plan.h"
#include "experiments/compare/mesh_runs.h"
#include "experiments/compare/plan.h"
#include "palpate/core/error.h"

namespace palpate::compare {
namespace {

using scene::Description;

/// Differences below this share of the largest value are too small to be worth shorter steps.
constexpr double kNegligible = 1e-4;

/// Returns the largest magnitude, the magnitude at `hold_s` (the last one before it), and the RMS.
std::vector<double> figures_of(const MeshRun& run, double hold_s) {
  const VecX magnitude = run.series.colwise().norm().transpose();
  if (magnitude.size() == 0) return {kEmpty, kEmpty, kEmpty};
  double hold = kEmpty;
  for (std::size_t i = 0; i < run.times.size() && run.times[i] <= hold_s * (1.0 + 1e-9); ++i)
    hold = magnitude[static_cast<Eigen::Index>(i)];
  return {magnitude.maxCoeff(), hold,
          std::sqrt(magnitude.squaredNorm() / static_cast<double>(magnitude.size()))};
}

double rms_difference(const MeshRun& a, const MeshRun& b) {
  if (a.series.cols() != b.series.cols() || a.series.cols() == 0) return kEmpty;
  return std::sqrt((a.series - b.series).squaredNorm() / static_cast<double>(a.series.cols()));
}

/// One level with its run at the present steps, and the run that checks it.
struct Planned {
  std::string run, check;
};

/// Levels of one resolution while it is being compared.
struct Work {
  MeshVariable out;
  std::vector<Planned> planned;
  int halvings = 0;
  bool needs_shorter_steps = false;
};

class Comparer {
 public:
  Comparer(const Description& d, const MeshOptions& options)
      : scene_(d),
        options_(options),
        runs_(options.limit_s, options.jobs <= 0),
        meshes_((std::filesystem::path(options.folder) / "meshes").string(), options.make_model) {
    out_.scene = d.name;
    out_.path = d.path;
    out_.tool = d.tool.has_value();
    const double duration_s = d.compare.duration_s > 0.0 ? d.compare.duration_s : d.duration_s;
    const double held = d.tool ? end_of_hold(d, duration_s) : duration_s;
    out_.hold_s = std::isfinite(held) ? held : 0.0;
    out_.figures = {"peak", d.tool ? "hold" : "end", "RMS"};
  }

  MeshComparison compare(const experiments::Place& place, experiments::EngineOutcome& outcome) {
    std::vector<Work> work = plan();
    for (int round = 0; round <= options_.halvings; ++round) {
      for (Work& one : work)
        if (round == 0 || one.needs_shorter_steps) add_runs(one, round);
      run(place, outcome);
      if (round == 0) out_.reused = static_cast<long>(outcome.reused);
      bool again = false;
      for (Work& one : work) {
        if (round == 0 || one.needs_shorter_steps) take(one);
        again = again || one.needs_shorter_steps;
      }
      if (!again || outcome.stopped) break;
    }
    for (Work& one : work) out_.variables.push_back(std::move(one.out));
    out_.stopped = outcome.stopped;
    out_.made_by = mesh_steps(scene_, 0).made_by;
    out_.rules = fmt::format(
        "Each run had a separate process, {} at a time, and at most {:g} CPU seconds. Steps were halved up "
        "to "
        "{} times, until the change from steps twice as long was below a tenth of the difference between "
        "levels.",
        std::max(1, options_.jobs), options_.limit_s, options_.halvings);
    return std::move(out_);
  }

 private:
  std::vector<Work> plan() const {
    std::vector<Work> out;
    for (const std::string& variable : options_.variables) {
      Work one;
      one.out.name = variable;
      one.out.unchanged = why_unchanged(scene_, variable);
      if (one.out.unchanged.empty())
        // A skin alone has no coarser level: it is divided where it is.
        for (int level = variable == kSkin ? 0 : -options_.coarser;
             level < options_.levels - options_.coarser; ++level) {
          one.out.levels.emplace_back();
          one.out.levels.back().divisions = level;
        }
      out.push_back(std::move(one));
    }
    return out;
  }

  /// Adds the runs of a resolution with steps halved `halvings` times.  A level that cannot be made is
  /// rejected, and so are the finer ones.
  void add_runs(Work& work, int halvings) {
    work.halvings = halvings;
    work.planned.assign(work.out.levels.size(), {});
    for (std::size_t i = 0; i < work.out.levels.size(); ++i) {
      MeshLevel& level = work.out.levels[i];
      try {
        const std::vector<std::string> resolution =
            mesh_overrides(scene_, work.out.name, level.divisions, meshes_);
        const auto add = [&](int divisions) {
          std::vector<std::string> all = resolution;
          const MeshSteps steps = mesh_steps(scene_, divisions);
          all.insert(all.end(), steps.overrides.begin(), steps.overrides.end());
          return runs_.add(with_overrides(scene_, all),
                           fmt::format("{} 1/{:g}", work.out.name, std::ldexp(1.0, level.divisions)));
        };
        work.planned[i] = {add(halvings), add(halvings - 1)};
      } catch (const Error& e) {
        level.status = Status::kRefused;
        level.reason = e.what();
      }
    }
    work.out.step_s = mesh_steps(scene_, halvings).step_s;
  }

  void run(const experiments::Place& place, experiments::EngineOutcome& outcome) {
    experiments::EngineOptions engine;
    engine.jobs = experiments::jobs_or_cores(options_.jobs);
    engine.stop = options_.stop;
    engine.progress = options_.progress;
    outcome = experiments::run(runs_, place, engine);
  }

  void take(Work& work) {
    const MeshRun* finest = nullptr;
    for (std::size_t i = work.out.levels.size(); i-- > 0;) {
      MeshLevel& level = work.out.levels[i];
      if (level.status == Status::kRefused && work.planned[i].run.empty()) continue;
      const MeshOutcome& outcome = runs_.outcome(work.planned[i].run);
      level.status = outcome.status;
      level.reason = outcome.reason;
      if (!outcome.run) continue;
      fill(level, *outcome.run, runs_.outcome(work.planned[i].check));
      level.from_finest = finest ? rms_difference(*outcome.run, *finest) : kEmpty;
      if (!finest) finest = &*outcome.run;
    }
    set_sizes(work.out);
    set_errors(work.out);
    work.needs_shorter_steps = work.out.step_s > 0.0 && has_unresolved(work.out);
  }

  void fill(MeshLevel& level, const MeshRun& run, const MeshOutcome& check) const {
    level.elements = run.elements;
    level.nodes = run.nodes;
    level.surface_vertices = run.surface_vertices;
    level.most_samples = run.most_samples;
    level.cpu_s = run.result.cpu_s;
    level.setup_s = run.setup_s;
    level.values.clear();
    const double hold = out_.hold_s > 0.0 ? out_.hold_s : -1.0;
    const std::vector<double> values = figures_of(run, hold);
    const std::vector<double> coarse = check.run ? figures_of(*check.run, hold) : values;
    for (std::size_t q = 0; q < values.size(); ++q)
      level.values.push_back({values[q], check.run ? std::abs(values[q] - coarse[q]) : kEmpty});
  }

  /// Sets the sizes relative to the scene's: by the number of elements where these are refined, because a
  /// generator rounds the number of its cells.
  static void set_sizes(MeshVariable& variable) {
    const bool by_elements = variable.name == kElements || variable.name == kTogether;
    const MeshLevel* own = nullptr;
    for (const MeshLevel& level : variable.levels)
      if (level.divisions == 0 && level.status == Status::kOk) own = &level;
    for (MeshLevel& level : variable.levels) {
      level.size = std::ldexp(1.0, -level.divisions);
      if (by_elements && own && level.elements > 0 && level.elements != own->elements)
        level.size = std::cbrt(static_cast<double>(own->elements) / static_cast<double>(level.elements));
    }
  }

  void set_errors(MeshVariable& variable) const {
    variable.errors.clear();
    std::vector<const MeshLevel*> ran;
    for (const MeshLevel& level : variable.levels)
      if (level.status == Status::kOk) ran.push_back(&level);
    for (std::size_t q = 0; q < out_.figures.size(); ++q) {
      std::vector<double> sizes, values;
      double time_error = 0.0;
      for (const MeshLevel* level : ran) {
        sizes.push_back(level->size);
        values.push_back(level->values[q].value);
        time_error = std::fmax(time_error, level->values[q].time_error);
      }
      MeshError error;
      const bool known = std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
      if (known) error.limit = estimate(sizes, values);
      for (std::size_t i = 0; known && i < ran.size(); ++i)
        if (ran[i]->divisions == 0) error.error = values[i] - error.limit.value;
      double least = HUGE_VAL;
      for (std::size_t i = 1; i < values.size(); ++i)
        least = std::fmin(least, std::abs(values[i] - values[i - 1]));
      if (least > 0.0 && std::isfinite(least) && !mesh_steps(scene_, 0).overrides.empty())
        error.time_share = time_error / least;
      else if (std::isfinite(least))
        error.time_share = 0.0;
      // Not resolved: time errors of both signs on two levels, extrapolated at order 1 and a ratio of 2.
      if (error.time_share > 1.0 / kResolution) error.limit.uncertainty += 3.0 * time_error;
      variable.errors.push_back(error);
    }
  }

  /// Whether the time error hides a difference between levels that is not negligible.
  bool has_unresolved(const MeshVariable& variable) const {
    for (std::size_t q = 0; q < variable.errors.size(); ++q) {
      const MeshError& error = variable.errors[q];
      if (!std::isfinite(error.time_share) || error.is_resolved()) continue;
      double largest = 0.0, difference = 0.0;
      for (std::size_t i = 0; i < variable.levels.size(); ++i) {
        if (variable.levels[i].values.empty()) continue;
        largest = std::max(largest, variable.levels[i].values[q].value);
        if (i > 0 && !variable.levels[i - 1].values.empty())
          difference = std::max(difference, std::abs(variable.levels[i].values[q].value -
                                                     variable.levels[i - 1].values[q].value));
      }
      if (difference > kNegligible * largest) return true;
    }
    return false;
  }

  const Description& scene_;
  const MeshOptions& options_;
  MeshRuns runs_;
  RefinedMeshes meshes_;
  MeshComparison out_;
};

}  // namespace

MeshComparison compare_mesh(const Description& description, const MeshOptions& options,
                            const experiments::Place& place, experiments::EngineOutcome& outcome) {
  const Description d = with_overrides(description, {});  // Only the text counts.
  if (d.bodies.empty()) fail("{}: there is no [[body]], so there is no mesh to refine", d.path);
  return Comparer(d, options).compare(place, outcome);
}

MeshComparison mesh_error(const Description& description, const std::string& folder,
                          const MakeModel& make_model, const experiments::Place& place) {
  MeshOptions options;
  options.make_model = make_model;
  options.levels = 2;
  options.halvings = 0;
  const Description d = with_overrides(description, {});
  options.variables.clear();
  for (const char* variable : {kTogether, kElements, kPoints})
    if (options.variables.empty() && why_unchanged(d, variable).empty()) options.variables = {variable};
  options.folder = folder;
  experiments::EngineOutcome outcome;
  return compare_mesh(description, options, place, outcome);
}

}  // namespace palpate::compare
