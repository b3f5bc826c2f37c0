#include "stability_haptic.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "cli/missing_outputs.h"
#include "cli/paths.h"
#include "cli/progress.h"
#include "cli/scene_of.h"
#include "cli/stop.h"
#include "haptic_stability/z_width.h"
#include "palpate/core/error.h"
#include "palpate/core/log.h"
#include "report/run_report.h"
#include "report/table.h"
#include "store/csv.h"
#include "store/folder_lock.h"
#include "store/summary.h"

namespace palpate::cli {
namespace {

using namespace palpate::haptic_stability;
namespace fs = std::filesystem;

/// Acceptance limit of the relative difference between simulation and exact theory.
constexpr double kAgreement = 0.05;
constexpr double kHapticDuration = 4.0;  ///< Simulated time of each wall [s]

std::string stiffness_text(double value) {
  return std::isinf(value) ? fmt::format("> {:g}", kStiffest) : fmt::format("{:.4g}", value);
}

std::string arm_text(const OneAxisLoop::Axis& device) {
  if (!device.held()) return {};
  return fmt::format(" in an arm of {:g} kg, {:g} N s/m, {:g} N/m", device.arm_mass_kg,
                     device.arm_damping_n_s_m, device.arm_stiffness_n_m);
}

void print_rows(const ZWidth& z) {
  std::vector<std::vector<std::string>> rows;
  for (const ZWidthRow& r : z.rows)
    rows.push_back({fmt::format("{:.3g}", r.damping), stiffness_text(r.passive), stiffness_text(r.spectral),
                    stiffness_text(r.delay_bound), stiffness_text(r.simulated),
                    fmt::format("{:.4f}", r.simulated / r.spectral), stiffness_text(r.in_contact)});
  fmt::print("{}", report::format_table({"B [N s/m]", "K passive [N/m]", "K spectral", "K delay bound",
                                         "K simulated", "simulated/spectral", "coupling, tool pressed"},
                                        rows));
}

/// Prints the operating points as a table.
/// @param scale  conversion factor from [N/m] to `unit`
void print_points(const std::vector<OperatingPoint>& points, double scale, const std::string& unit) {
  std::vector<std::vector<std::string>> rows;
  for (const OperatingPoint& p : points)
    rows.push_back({p.name, fmt::format("{:.4g}", scale * p.contact.stiffness),
                    fmt::format("{:.4g}", scale * p.series), fmt::format("{:.6f}", p.radius),
                    p.simulated_stable ? "stable" : "unstable"});
  fmt::print("{}",
             report::format_table({"", fmt::format("contact [{}]", unit),
                                   fmt::format("with coupling [{}]", unit), "spectral radius", "simulated"},
                                  rows));
}

void print_rotation(const RotationalLoop& r, const std::vector<OperatingPoint>& points) {
  const double a2 = r.lever_m * r.lever_m;
  fmt::print(
      "about the axis of least inertia of the tool, {:.3g} kg m^2; coupling {:.4g} N m/rad, {:.3g} N m "
      "s/rad; ",
      r.inertia_kg_m2, a2 * r.loop.coupling_stiffness_n_m, a2 * r.loop.coupling_damping_n_s_m);
  if (r.driven)
    fmt::print("device and arm of {:.3g} kg m^2\n\n", a2 * r.loop.device.total_mass());
  else
    fmt::print("the device renders no torque: the rotation of its handle is held\n\n");
  print_points(points, a2, "N m/rad");
}

/// Returns the operating points that are unstable by theory or by simulation; `how` is "translation" or
/// "rotation".
std::vector<std::string> unstable_points(const std::vector<OperatingPoint>& points, const std::string& how) {
  std::vector<std::string> out;
  for (const OperatingPoint& p : points)
    if (!p.simulated_stable || p.radius > 1.0 + 1e-9) out.push_back(fmt::format("{} ({})", p.name, how));
  return out;
}

void write_csv(const ZWidth& z, const std::string& path) {
  store::CsvWriter csv(path, {"damping_n_s_m", "k_passive_n_m", "k_spectral_n_m", "k_delay_bound_n_m",
                              "k_simulated_n_m", "coupling_in_contact_n_m"});
  for (const auto* rows : {&z.rows, &z.fine})
    for (const ZWidthRow& r : *rows)
      csv.row(
          std::vector<double>{r.damping, r.passive, r.spectral, r.delay_bound, r.simulated, r.in_contact});
  csv.close();
}

ToolContactRange range_of(const StabilityArguments& a, const scene::Description& description) {
  if (a.contact_stiffness_n_m.empty()) return contact_range(description);
  ToolContactRange out;
  out.least.stiffness = a.contact_stiffness_n_m.front();
  out.greatest.stiffness = a.contact_stiffness_n_m.back();
  if (!(out.least.stiffness > 0.0 && out.least.stiffness <= out.greatest.stiffness))
    fail("--contact-stiffness-n-m {} {}: must be two positive values, the smaller first", out.least.stiffness,
         out.greatest.stiffness);
  return out;
}

/// Returns the verdicts on the loop, one line per verdict, for standard output, summary.json and the page.
/// @param scale  conversion factor of the rotation, from [N/m] to [N m/rad]
std::vector<std::string> verdicts_of(const ZWidth& z, double tick_s,
                                     const std::vector<OperatingPoint>& points,
                                     const std::vector<OperatingPoint>& turning, double scale) {
  std::vector<std::string> out;
  std::vector<std::string> unstable = unstable_points(points, "translation");
  for (const std::string& one : unstable_points(turning, "rotation")) unstable.push_back(one);
  if (!unstable.empty())
    out.push_back(fmt::format("the loop of this scene is UNSTABLE: {}", fmt::join(unstable, ", ")));
  else
    out.emplace_back("the loop of this scene is stable, in the air and in contact");
  for (const OperatingPoint& p : points)
    out.push_back(fmt::format("{}, translation: {}", p.name, p.words(tick_s)));
  for (const OperatingPoint& p : turning)
    out.push_back(fmt::format("{}, rotation: {}", p.name, p.words(tick_s, scale, "N m/rad")));
  if (std::all_of(z.rows.begin(), z.rows.end(), [](const ZWidthRow& r) { return r.passive <= 0.0; }))
    out.emplace_back("no wall is passive: the device has no viscous friction, which passivity requires");
  if (z.stopped)
    out.emplace_back("stopped before all walls were simulated");
  else
    out.push_back(fmt::format(
        "the passive walls are {} the stable ones; simulation and theory differ by at most {:.2g} %",
        z.passive_within_stable() ? "within" : "NOT within", 100.0 * z.largest_difference()));
  return out;
}

/// @param scale  from [N/m] to the unit whose suffix is `unit`
void add_point(store::Summary& summary, const OperatingPoint& p, const char* motion, double scale,
               const std::string& unit) {
  summary.list("operating_points")
      .push_back({{"name", p.name},
                  {"motion", motion},
                  {"contact_stiffness" + unit, scale * p.contact.stiffness},
                  {"stiffness_with_coupling" + unit, scale * p.series},
                  {"spectral_radius", p.radius},
                  {"simulated_stable", p.simulated_stable},
                  {"passive", p.passive}});
}

void keep_summary(const StabilityArguments& a, const scene::Description& d, const ZWidth& z,
                  double coupling_damping_n_s_m, const std::vector<OperatingPoint>& points,
                  const RotationalLoop& rotation, const std::vector<OperatingPoint>& turning,
                  const std::vector<std::string>& verdicts, const std::string& folder) {
  store::Summary summary;
  summary.remarks = log::warnings();
  summary.remarks.insert(summary.remarks.end(), verdicts.begin(), verdicts.end());
  summary.command = "palpate stability --haptic " + a.scene.scene;
  summary.scene = d.name;
  summary.scene_source = d.source;
  summary.overrides = a.scene.overrides;
  summary.outcome = z.stopped ? "interrupted" : "finished";
  summary.provenance = store::provenance();
  summary.section("haptic_stability").values = {{"passive_within_stable", z.passive_within_stable()},
                                                {"largest_relative_difference", z.largest_difference()},
                                                {"coupling_damping_n_s_m", coupling_damping_n_s_m}};
  for (const OperatingPoint& p : points) add_point(summary, p, "translation", 1.0, "_n_m");
  const double a2 = rotation.lever_m * rotation.lever_m;
  for (const OperatingPoint& p : turning) add_point(summary, p, "rotation", a2, "_n_m_rad");
  store::write_summary((fs::path(folder) / "summary.json").string(), summary);
}

}  // namespace

int stability_haptic(const StabilityArguments& a) {
  const scene::Description description = scene_of(a.scene);
  OneAxisLoop loop = loop_of(description);
  loop.device.mass_kg = a.device_mass_kg.value_or(loop.device.mass_kg);
  loop.device.damping_n_s_m = a.device_damping_n_s_m.value_or(loop.device.damping_n_s_m);
  loop.delay_ticks = a.delay_ticks.value_or(loop.delay_ticks);
  const ToolContactRange range = range_of(a, description);
  const std::vector<OperatingPoint> points = operating_points(loop, range, kHapticDuration);
  const RotationalLoop rotation = rotational_loop_of(description, loop, range);
  const std::vector<OperatingPoint> turning =
      operating_points(rotation.loop, rotation.range, kHapticDuration);
  loop.contact_stiffness_n_m = range.greatest.stiffness;
  loop.contact_damping_n_s_m = range.greatest.damping;

  const std::string folder =
      a.folder.empty() ? default_folder("stability-haptic-" + short_name(description)) : a.folder;
  const store::FolderLock mine(folder);
  ZWidth z;
  {
    Progress progress("haptic stability");
    ZWidthOptions options;
    options.duration_s = kHapticDuration;
    options.progress = [&progress](double fraction) { progress(fraction); };
    options.stop = &stop_flag();
    z = z_width(loop, options);
  }
  const double scale = rotation.lever_m * rotation.lever_m;
  const std::vector<std::string> verdicts = verdicts_of(z, loop.tick_s, points, turning, scale);
  for (const std::string& verdict : verdicts) fmt::print("{}\n", verdict);
  fmt::print(
      "\ndevice of {:g} kg and {:g} N s/m{}, tick {:g} ms, delay {} tick{}; coupling {:g} N/m, {:g} N "
      "s/m\n\n",
      loop.device.mass_kg, loop.device.damping_n_s_m, arm_text(loop.device), 1e3 * loop.tick_s,
      loop.delay_ticks, loop.delay_ticks == 1 ? "" : "s", loop.coupling_stiffness_n_m,
      loop.coupling_damping_n_s_m);
  print_rows(z);
  fmt::print("\n");
  print_points(points, 1.0, "N/m");
  fmt::print("\n");
  print_rotation(rotation, turning);

  MissingOutputs missing;
  write_csv(z, (fs::path(folder) / "z_width.csv").string());
  keep_summary(a, description, z, loop.coupling_damping_n_s_m, points, rotation, turning, verdicts, folder);
  const report::RunReport written = report::write_run_report(folder);
  report::add_missing(written, missing);
  fmt::print("\nwritten: {}\n", written.page.string());
  if (z.stopped) return kExitStopped;
  const bool stable = unstable_points(points, "").empty() && unstable_points(turning, "").empty();
  return missing.close(
      z.passive_within_stable() && z.largest_difference() <= kAgreement && stable ? 0 : kExitError);
}

}  // namespace palpate::cli
