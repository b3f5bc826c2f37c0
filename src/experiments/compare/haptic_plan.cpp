#include "experiments/compare/haptic_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "experiments/compare/cells.h"
#include "experiments/compare/monolithic.h"
#include "experiments/compare/plan.h"
#include "experiments/median.h"
#include "loop/registries.h"
#include "palpate/core/error.h"
#include "palpate/core/named_enum.h"
#include "palpate/loop/load.h"
#include "scene/contact_sides.h"

namespace palpate::compare {
namespace {

using scene::Description;

/// Ticks per period for "exchange alone".
constexpr int kTicksAlone = 10;
/// Tolerance of the reference's iterative linear solver.
constexpr double kLinearRtol = 1e-8;

/// Returns the texts that a key may have, parsed from its documentation ("\"condensed\", \"frozen\"").
std::vector<std::string> texts_of(const std::string& table, const std::string& key) {
  std::vector<std::string> out;
  for (const scene::KeyRow& row : scene::key_rows(loop::kinds())) {
    if (row.table != table || row.name != key) continue;
    std::size_t open = row.range.find('"');
    while (open != std::string::npos) {
      const std::size_t close = row.range.find('"', open + 1);
      if (close == std::string::npos) break;
      out.push_back(row.range.substr(open + 1, close - open - 1));
      open = row.range.find('"', close + 1);
    }
  }
  return out;
}

/// Returns the longest time up to `most` of which `period` is a multiple.
double fraction_of(double period, double most) {
  return period / std::max(1.0, std::ceil(period / most - 1e-9));
}

std::string assign(const std::string& key, double value) { return key + "=" + toml_number(value); }
std::string assign(const std::string& key, const std::string& value) { return key + "=\"" + value + '"'; }

std::string milliseconds(double s) { return fmt::format("{:.4g} ms", 1e3 * s); }

/// Whether the tool's contact is found in an image.
bool is_image(const Description& d, ContactSpec contact) {
  contact.method = scene::contact_method(d, contact);
  return contact.second == "tool" && scene::is_in_images(contact);
}

std::vector<std::size_t> image_contacts(const Description& d) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < d.contacts.size(); ++i)
    if (is_image(d, d.contacts[i])) out.push_back(i);
  return out;
}

const dynamics::StepperEntry& method_of(const Description& d, const char* name, const char* key) {
  const dynamics::StepperEntry& entry = find(loop::steppers(), name, key);
  if (entry.traits.stability == dynamics::Stability::kStatic)
    fail("{}: {}: {} cannot be a reference: it is a static solver", d.path, key, name);
  return entry;
}

/// Returns the method that checks a reference: the scene's, or one of another family, under error control or
/// with fixed steps, as the reference.
const dynamics::StepperEntry& check_of(const Description& d, const dynamics::StepperEntry& reference) {
  constexpr const char* kKey = "compare.haptic.reference_check";
  const std::string& named = d.compare.haptic.reference_check;
  const bool fixed = reference.traits.control == dynamics::StepControl::kFixed;
  const auto other = [&](const char* usual, const char* instead) {
    return find_stepper(usual)->traits.family != reference.traits.family ? usual : instead;
  };
  const dynamics::StepperEntry& check = method_of(d,
                                                  !named.empty() ? named.c_str()
                                                  : fixed ? other("generalized-alpha", "implicit-midpoint")
                                                          : other("ark-dirk-esdirk437", "cvode-bdf"),
                                                  kKey);
  if (check.traits.family == reference.traits.family)
    fail("{}: {}: {} and {} belong to the same family, {}, so their errors may be alike; choose another",
         d.path, kKey, check.name, reference.name, check.traits.family);
  return check;
}

/// Returns the overrides of the monolithic solution except the scheme: integrator, tolerance or step, and
/// contact refresh.
/// @param coarser  above 1: the check, coarser by that factor, of another family, with another factorisation
std::vector<std::string> monolithic_overrides(const Description& d, double coarser) {
  const scene::HapticCompareSpec& h = d.compare.haptic;
  const dynamics::StepperEntry& reference = method_of(d, h.reference.c_str(), "compare.haptic.reference");
  const dynamics::StepperEntry& entry = coarser > 1.0 ? check_of(d, reference) : reference;
  scene::LadderSpec ladder;
  ladder.integrator = entry.name;
  const bool fixed = entry.traits.control == dynamics::StepControl::kFixed;
  if (fixed) ladder.setting = "step_s";
  // The error is of first order in the refresh period and in the tolerance: the reference's errors are then
  // well below the check's.
  std::vector<std::string> out = overrides_of(
      ladder, fixed ? coarser * h.reference_step_s : std::pow(coarser, std::log2(10.0)) * h.reference_rtol);
  out.push_back(assign("exchange.contact_refresh_s", coarser * h.reference_refresh_s));
  if (coarser > 1.0 && entry.traits.implicit)
    out.push_back(assign("integrator.linear_solver",
                         std::string(d.integrator.linear_solver == "cholmod" ? "umfpack" : "cholmod")));
  return out;
}

/// Returns the scene with overrides, and with the linear tolerance of the reference, which no key of
/// [compare.haptic] sets.
Description as_tight_as_the_reference(const Description& d, std::vector<std::string> overrides) {
  Description out = with_overrides(d, overrides);
  if (out.integrator.linear_rtol <= kLinearRtol) return out;
  overrides.push_back(assign("integrator.linear_rtol", kLinearRtol));
  return with_overrides(d, overrides);
}

/// Plan of the points.
class Plan {
 public:
  explicit Plan(const Description& d) : scene_(d) {}

  /// Adds one point.
  /// @param own  whether the value is the value of the scene, so that no key is changed
  void add(const char* variable, const std::string& value, double setting, bool own,
           const std::vector<std::string>& overrides) {
    HapticPoint point;
    point.variable = variable;
    point.value = value;
    point.setting = setting;
    point.own = own;
    try {
      if (own)
        point.description = scene_;
      else if (variable == std::string_view(kAlone))
        point.description = as_tight_as_the_reference(scene_, overrides);
      else
        point.description = with_overrides(scene_, overrides);
    } catch (const Error& e) {  // A period that is no multiple of the tick rejects only this point.
      point.status = Status::kRefused;
      point.reason = e.what();
    }
    points.push_back(std::move(point));
  }

  /// Adds numbers from coarse to fine, including the scene's value.  @param make  returns the overrides for
  /// one value
  template <class Make>
  void add_numbers(const char* variable, std::vector<double> values, double own, bool finer_is_less,
                   std::string (*text)(double), Make make) {
    const auto same = [own](double v) { return std::abs(v - own) <= 1e-9 * std::abs(own); };
    if (own > 0.0 && std::none_of(values.begin(), values.end(), same)) values.push_back(own);
    std::sort(values.begin(), values.end(),
              [=](double a, double b) { return finer_is_less ? a > b : a < b; });
    for (const double v : values) add(variable, text(v), v, own > 0.0 && same(v), make(v));
  }

  template <class Make>
  void add_names(const char* variable, std::vector<std::string> values, const std::string& own, Make make) {
    if (std::find(values.begin(), values.end(), own) == values.end()) values.insert(values.begin(), own);
    for (const std::string& v : values) add(variable, v, kEmpty, v == own, make(v));
  }

  std::vector<HapticPoint> points;

 private:
  const Description& scene_;
};

std::vector<std::string> period_overrides(double period, double refresh) {
  return {assign("exchange.exchange_period_s", period),
          assign("exchange.contact_refresh_s", fraction_of(period, refresh))};
}

/// Returns overrides that leave only exchange and tick as sources of error: the rest is as in the reference.
std::vector<std::string> alone_overrides(const Description& d, double period) {
  std::vector<std::string> out = monolithic_overrides(d, 1.0);
  out.back() = assign("exchange.contact_refresh_s",
                      fraction_of(period, std::min(period, d.compare.haptic.reference_refresh_s)));
  out.push_back(assign("exchange.exchange_period_s", period));
  out.push_back(assign("tool.tick_s", period / kTicksAlone));
  return out;
}

void add_resolution(Plan& plan, const Description& d) {
  const scene::HapticCompareSpec& h = d.compare.haptic;
  if (const std::vector<std::size_t> images = image_contacts(d); !images.empty())
    plan.add_numbers(
        kPixels, h.pixels, 0.0, false, [](double v) { return fmt::format("{:g}", v); },
        [&](double v) {
          std::vector<std::string> out;
          for (const std::size_t i : images)
            out.push_back(fmt::format("contact.{}.pixels={}", i, std::lround(v)));
          return out;
        });
  std::vector<std::size_t> meshed;
  for (std::size_t b = 0; b < d.bodies.size(); ++b)
    if (!d.bodies[b].mesh.generator.empty()) meshed.push_back(b);
  if (meshed.empty() || h.element_sizes_m.empty()) return;
  plan.add_numbers(
      kElement, h.element_sizes_m, d.bodies[meshed.front()].mesh.element_size_m, true,
      [](double v) { return fmt::format("{:.4g} mm", 1e3 * v); },
      [&](double v) {
        std::vector<std::string> out;
        for (const std::size_t b : meshed)
          out.push_back(assign(fmt::format("body.{}.mesh.element_size_m", b), v));
        return out;
      });
}

/// Returns the least-squares slope of log y over log x; NaN with fewer than two points.
double slope(const std::vector<double>& x, const std::vector<double>& y) {
  if (x.size() < 2) return kEmpty;
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  const auto n = static_cast<double>(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double u = std::log(x[i]), v = std::log(y[i]);
    sx += u, sy += v, sxx += u * u, sxy += u * v;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

}  // namespace

MonolithicScene monolithic_scene(const Description& d, double coarser) {
  std::vector<std::string> overrides = monolithic_overrides(d, coarser);
  overrides.push_back(assign("exchange.scheme", std::string("monolithic")));
  MonolithicScene out{coarser > 1.0 ? with_overrides(d, overrides) : as_tight_as_the_reference(d, overrides),
                      ""};
  const IntegratorSpec& made = out.description.integrator;
  const bool fixed = find_stepper(made.name)->traits.control == dynamics::StepControl::kFixed;
  out.made_by = fmt::format(
      "monolithic solution by {} {}{}, contact refreshed every {}", made.name,
      fixed ? "in steps of " + milliseconds(made.step_s) : fmt::format("at rtol {:.2g}", made.rtol),
      coarser > 1.0 ? " by " + made.linear_solver : std::string(),
      milliseconds(out.description.exchange.contact_refresh_s));
  return out;
}

std::vector<HapticPoint> plan_haptic(const Description& d, const std::vector<std::string>& integrators) {
  const scene::HapticCompareSpec& h = d.compare.haptic;
  const scene::CosimulationSpec& x = d.exchange;
  Plan plan(d);
  const bool exchanges = x.scheme == scene::ExchangeScheme::kPartitioned;
  if (exchanges) {
    plan.add_numbers(kPeriod, h.exchange_periods_s, x.exchange_period_s, true, milliseconds,
                     [&](double v) { return period_overrides(v, x.contact_refresh_s); });
    plan.add_numbers(kAlone, h.exchange_periods_s, 0.0, true, milliseconds,
                     [&](double v) { return alone_overrides(d, v); });
  }
  plan.add_numbers(kTick, h.ticks_s, d.tool->tick_s, true, milliseconds,
                   [](double v) { return std::vector{assign("tool.tick_s", v)}; });
  add_resolution(plan, d);
  plan.add_names(kIntegrator, integrators.empty() ? h.integrators : integrators, d.integrator.name,
                 [](const std::string& v) { return std::vector{assign("integrator.name", v)}; });
  plan.add_names(kScheme, {"partitioned", "single_rate"}, std::string(name_of(x.scheme)),
                 [](const std::string& v) { return std::vector{assign("exchange.scheme", v)}; });
  if (!exchanges) return plan.points;
  plan.add_names(
      kLinearisation, h.linearisations.empty() ? texts_of("exchange", "linearisation") : h.linearisations,
      x.linearisation, [](const std::string& v) { return std::vector{assign("exchange.linearisation", v)}; });
  return plan.points;
}

void summarise(HapticPoint& point, const TrajectoryError& own) {
  // NaN is never unresolved.
  point.force_unresolved = point.error.force_rms_n < kResolution * own.force_rms_n;
  point.torque_unresolved = point.error.torque_rms_n_m < kResolution * own.torque_rms_n_m;
  if (!point.cpu_s.empty()) point.cpu_median_s = experiments::median(point.cpu_s);
}

std::vector<HapticOrder> haptic_orders(const HapticComparison& c) {
  std::vector<HapticOrder> out;
  for (const char* variable : {kPeriod, kAlone, kTick}) {
    std::vector<double> h_force, force, h_torque, torque;
    for (const HapticPoint& p : c.points) {
      if (p.variable != variable || p.status != Status::kOk) continue;
      if (const double e = p.error.force_rms_n;
          e > 0.0 && !p.force_unresolved && share_of_peak(e, c.peak_force_n) <= kOrderPeakShare)
        h_force.push_back(p.setting), force.push_back(e);
      if (const double e = p.error.torque_rms_n_m;
          e > 0.0 && !p.torque_unresolved && share_of_peak(e, c.peak_torque_n_m) <= kOrderPeakShare)
        h_torque.push_back(p.setting), torque.push_back(e);
    }
    out.push_back({variable, slope(h_force, force), slope(h_torque, torque), static_cast<int>(force.size()),
                   static_cast<int>(torque.size())});
  }
  return out;
}

}  // namespace palpate::compare
