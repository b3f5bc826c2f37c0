#include "loop/summary.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "contact/gpu_device.h"
#include "contact/sources.h"
#include "core/clock.h"
#include "core/counters.h"
#include "model_reduction.h"
#include "palpate/device/profile.h"
#include "palpate/integrate/integrators.h"
#include "palpate/linear/solvers.h"
#include "palpate/scene/hands.h"
#include "palpate/tool/tool.h"
#include "proxy/pruner.h"
#include "store/model_cache.h"
#include "tool_instance.h"

namespace palpate::loop {
namespace {

/// Adds all results of one type of number: counts, or times.
template <class Number>
void add_numbers(store::SummarySection& s, const RunResult& result) {
  const auto add = [&s]<class T>(const char* name, const T& value) {
    if constexpr (std::is_same_v<T, Number>)
      s.values.emplace_back(name,
                            static_cast<std::conditional_t<std::is_integral_v<T>, long long, T>>(value));
  };
  visit_counters(add, result);
}

void add_sizes(store::SummarySection& s, const World& world) {
  long long nodes = 0, tets = 0;
  for (const Body& body : world.bodies) {
    nodes += body.rest.nodes.cols();
    tets += body.rest.tets.cols();
  }
  s.values.emplace_back("bodies", static_cast<long long>(world.bodies.size()));
  s.values.emplace_back("nodes", nodes);
  s.values.emplace_back("tetrahedra", tets);
  s.values.emplace_back("peak_memory_mib", peak_memory_mib());
}

void add_options(store::SummarySection& s, const scene::Description& d) {
  if (!d.path.empty())  // else the scene was not read from a file
    s.values.emplace_back("scene_path", std::filesystem::absolute(d.path).lexically_normal().string());
  s.values.emplace_back("integrator", d.integrator.name);
  s.values.emplace_back("rtol", d.integrator.rtol);
  if (const auto used = integrate::error_test_rtol_of(d.integrator))
    s.values.emplace_back("error_test_rtol", *used);
  s.values.emplace_back("step_s", d.integrator.step_s);
  s.values.emplace_back("linear_solver", integrate::linear_solver_of(d.integrator));
  s.values.emplace_back("threads", static_cast<long long>(d.integrator.threads));
  if (!d.tool) return;
  const bool monolithic = d.exchange.scheme == "monolithic";
  s.values.emplace_back("exchange_scheme", d.exchange.scheme);
  s.values.emplace_back("contact_refresh_s", d.exchange.contact_refresh_s);
  if (!monolithic) {
    s.values.emplace_back("exchange_period_s", d.exchange.exchange_period_s);
    s.values.emplace_back("linearisation", d.exchange.linearisation);
  }
  s.values.emplace_back("tool_integrator", monolithic ? d.integrator.name : d.tool->integrator);
  const device::DeviceFigures figures = device::figures_of(*d.device);
  s.values.emplace_back("max_force_n", figures.max_force);
  s.values.emplace_back("max_torque_n_m", figures.max_torque);
}

/// Returns the provenance from store, with the libraries of the other parts.
store::Provenance full_provenance() {
  store::Provenance p = store::provenance();
  for (const auto& library : integrate::library_versions()) p.libraries.push_back(library);
  for (const auto& library : linear::library_versions()) p.libraries.push_back(library);
  if (tool::available()) p.libraries.emplace_back("Simbody", tool::simbody_version());
  return p;
}

/// Adds the cached files of models that the scene specifies by "model:NAME".
void add_models(store::Summary& summary, const scene::Description& d) {
  const auto add = [&](const std::string& file) {
    const std::string name = store::name_of_cached(file);
    if (name.empty()) return;
    auto& kept = summary.section("models").values;
    if (std::none_of(kept.begin(), kept.end(), [&](const auto& value) { return value.first == name; }))
      kept.emplace_back(name, file);
  };
  for (const SoftBodySpec& body : d.bodies) add(body.mesh.file);
  for (const scene::Hand& hand : scene::hands_of(d)) add(hand.tool->mesh.file);
}

/// Adds the changes of the resultants on bodies by queries: with images, the pairs and normals of a query
/// hold until the next.
void add_jumps(store::Summary& summary, const World& world) {
  if (!world.contact) return;
  store::SummarySection& s = summary.section("contact");
  const contact::ResultantSize jump = world.contact->largest_jump(),
                               after = world.contact->largest_resultant();
  s.values.emplace_back("largest_force_jump_at_a_query_n", jump.force);
  s.values.emplace_back("largest_moment_jump_at_a_query_n_m", jump.moment);
  s.values.emplace_back("largest_force_after_a_query_n", after.force);
  s.values.emplace_back("largest_moment_after_a_query_n_m", after.moment);
  const std::vector<long> fast = world.contact->fast_regions();
  const std::vector<long> kept = world.contact->normals_kept();
  const std::vector<Overlap> overlaps = overlaps_of(world);
  for (std::size_t i = 0; i < fast.size(); ++i) {
    const Overlap& overlap = overlaps[i];
    s.values.emplace_back(overlap.pair + ": regions fast enough to go through",
                          static_cast<long long>(fast[i]));
    s.values.emplace_back(overlap.pair + ": deep poses that kept the last normal",
                          static_cast<long long>(kept[i]));
    s.values.emplace_back(overlap.pair + ": deepest_overlap_m", overlap.deepest_m);
    if (overlap.quadrature_error > 0.0)
      s.values.emplace_back(overlap.pair + ": largest_quadrature_error", overlap.quadrature_error);
    if (overlap.largest_share > 0.0)
      s.values.emplace_back(overlap.pair + ": largest_share_of_a_point", overlap.largest_share);
  }
  long pairs = 0;
  bool images = false;
  for (const contact::QueryStages* stages : world.contact->stages())
    if (stages) {
      images = true;
      pairs += stages->pairs;
    }
  if (images) s.values.emplace_back("pixels_seen", static_cast<long long>(pairs));
  if (const double friction = world.contact->largest_lagged_friction(); friction > 0.0) {
    s.values.emplace_back("largest_friction_n", friction);
    s.values.emplace_back("largest_friction_left_out_of_a_step_n", world.contact->largest_friction_lag());
  }
}

void add_answers(store::Summary& summary, const World& world) {
  for (const AnswerError& e : answer_errors_of(world))
    summary.section("answers to " + e.tool).values = {
        {"wanted_error", e.requested},
        {"largest_error_bound", e.largest},
        {"mean_error_bound", e.mean},
        {"exchanges", static_cast<long long>(e.exchanges)},
        {"exchanges_beyond_wanted_error", static_cast<long long>(e.beyond)},
        {"exchanges_factored", static_cast<long long>(e.factored)}};
}

/// Adds the grasps of the tools.
void add_grasps(store::Summary& summary, const World& world) {
  if (!world.contact) return;
  const contact::GraspCounts counts = world.contact->grasp_counts();
  if (counts.closed + counts.empty == 0) return;
  summary.section("grasps").values = {{"closed", static_cast<long long>(counts.closed)},
                                      {"closed_on_nothing", static_cast<long long>(counts.empty)},
                                      {"largest_area_m2", counts.largest_area},
                                      {"area_at_the_end_m2", counts.area}};
}

/// Adds the contacts with images, and the device that renders them.
void add_images(store::Summary& summary, const World& world) {
  if (!world.contact) return;
  const auto stages = world.contact->stages();
  const auto methods = world.contact->methods();
  for (std::size_t i = 0; i < stages.size(); ++i) {
    if (!stages[i]) continue;
    const ContactSpec& contact = world.description.contacts[i];
    const std::string who = fmt::format("{} - {}", contact.first, contact.second);
    summary.section("images").values.emplace_back(who, methods[i]);
  }
  if (const contact::GpuDevice device = contact::gpu_device();
      !device.name.empty() &&
      std::any_of(stages.begin(), stages.end(), [](auto* s) { return s != nullptr; })) {
    store::SummarySection& s = summary.section("images");
    s.values.emplace_back("device", device.name);
    s.values.emplace_back("driver", device.driver);
    s.values.emplace_back("device_is_software", device.software);
  }
}

/// Adds the energy balance at the end of the run, if the scene records it.
void add_energy(store::Summary& summary, const RunResult& result) {
  if (!result.energy) return;
  store::SummarySection& s = summary.section("energy");
  visit_energies([&](const char* name, double value) { s.values.emplace_back(name, value); }, *result.energy);
}

/// Adds the vibration of a device's force, and the energy at its port.
void add_feel(store::SummarySection& s, const std::optional<double>& buzz_n,
              const std::optional<PortEnergy>& port) {
  if (buzz_n) s.values.emplace_back("buzz_above_30_hz_rms_n", *buzz_n);
  if (!port) return;
  s.values.insert(s.values.end(),
                  {{"port_energy_j", port->energy},
                   {"port_least_energy_j", port->least},
                   {"port_work_j", port->work},
                   {"passivity_controller_dissipated_j", port->controller_dissipated},
                   {"passivity_controller_ticks", static_cast<long long>(port->controller_ticks)}});
}

/// Adds the results of further hands.
void add_more_hands(store::Summary& summary, const scene::Description& d, const RunResult& result) {
  for (std::size_t i = 0; i < result.more_hands.size(); ++i) {
    const HandResult& hand = result.more_hands[i];
    const DeviceSpec& spec = d.hands[i].device;
    store::SummarySection& s = summary.section("hand " + d.hands[i].name);
    s.values = {{"ticks", static_cast<long long>(hand.ticks)},
                {"limited_ticks", static_cast<long long>(hand.limited_ticks)},
                {"ticks_outside_workspace", static_cast<long long>(hand.outside_ticks)},
                {"rejected_ticks", static_cast<long long>(hand.rejected_ticks)},
                {"max_force_n", device::figures_of(spec).max_force},
                {"max_torque_n_m", device::figures_of(spec).max_torque}};
    add_feel(s, hand.buzz_n, hand.port);
  }
}

/// Adds the counters of the devices.
void add_tallies(store::Summary& summary, const World& world) {
  if (!world.description.tool) return;
  for (std::size_t i = 0; i < scene::hands_of(world.description).size(); ++i)
    for (const auto& [name, count] : tallies_of(world, i))
      summary.section(i == 0 ? "device" : "hand " + world.description.hands[i - 1].name)
          .values.emplace_back(name, count);
}

/// Adds the timing of a run in real time.
void add_real_time(store::Summary& summary, const RunResult& result) {
  if (!result.real_time) return;
  store::SummarySection& s = summary.section("real time");
  s.values.emplace_back("scheduling", result.real_time->scheduling);
  s.values.emplace_back("processor", static_cast<long long>(result.real_time->cpu));
  s.values.emplace_back("memory", result.real_time->memory);
  visit_real_time([&](const char* name, auto value) { s.values.emplace_back(name, value); },
                  *result.real_time);
}

/// Adds the work that proxies saved in image contact, over all queries.
void add_pruning(store::Summary& summary, const World& world) {
  if (!world.contact) return;
  const auto counts = world.contact->pruning();
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (!counts[i]) continue;
    const proxy::PruneCounts& c = *counts[i];
    const ContactSpec& contact = world.description.contacts[i];
    store::SummarySection& s = summary.section("pruning");
    const auto add = [&](const char* what, auto value) {
      s.values.emplace_back(fmt::format("{} - {}: {}", contact.first, contact.second, what), value);
    };
    add("queries", static_cast<long long>(c.queries));
    add("pairs of proxies", static_cast<long long>(c.pairs));
    add("left by boxes", static_cast<long long>(c.after_boxes));
    add("left by hulls", static_cast<long long>(c.after_hulls));
    add("regions", static_cast<long long>(c.regions));
    add("of them apart, but fast enough to meet", static_cast<long long>(c.regions_ahead));
    for (const auto& [name, faces] :
         {std::pair(contact.first, c.faces_a), std::pair(contact.second, c.faces_b)}) {
      add(fmt::format("skin triangles of {} handed on", name).c_str(), static_cast<long long>(faces));
      const Body* body = world.find_body(name);  // else a tool
      if (body && c.queries > 0)
        add(fmt::format("share of the skin of {} handed on, mean", name).c_str(),
            static_cast<double>(faces) /
                (static_cast<double>(c.queries) * static_cast<double>(body->surface_faces().cols())));
    }
    add("largest rotation of a normal [rad]", c.largest_rotation);
  }
}

/// Returns half of the smallest extent of a side of a contact, along the axes in which it was defined [m].
double half_width(const World& world, const std::string& side) {
  const auto of_points = [](const Points& points) {
    return 0.5 * (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).minCoeff();
  };
  if (const Body* body = world.find_body(side)) return of_points(body->rest.nodes);
  if (const ToolSpec* tool = scene::tool_named(world.description, side))
    return tool->shape == "sphere" ? tool->radius_m : of_points(tool_surface(*tool, world.folder).vertices);
  for (const ObstacleSpec& obstacle : world.description.obstacles)
    if (obstacle.name == side)
      return 0.5 * contact::obstacle_entry(obstacle).lengths(contact::obstacle_shape(obstacle)).width;
  return HUGE_VAL;
}

double depth_within_itself(const Body& body) {
  return contact::own_contact_depth(contact::lengths_of(body.skin ? body.skin->rest : body.boundary.surface));
}

}  // namespace

std::vector<std::pair<std::string, long long>> tallies_of(const World& world, std::size_t hand) {
  const ToolInstance& side = ToolInstance::of(world, hand);
  return side.handle ? side.handle->counters() : std::vector<std::pair<std::string, long long>>{};
}

std::vector<AnswerError> answer_errors_of(const World& world) {
  std::vector<AnswerError> out;
  for (const auto& side : ToolInstance::all(world)) {
    if (!side->touch || side->touch->error_bound().exchanges == 0) continue;
    const ReductionError& m = side->touch->error_bound();
    out.push_back({side->name, world.description.exchange.linearisation_error, m.largest,
                   m.sum / static_cast<double>(m.exchanges), m.exchanges, m.beyond_wanted, m.factored});
  }
  return out;
}

std::vector<Overlap> overlaps_of(const World& world) {
  std::vector<Overlap> out;
  if (!world.contact) return out;
  const std::vector<double> deepest = world.contact->deepest();
  const std::vector<const contact::SumError*> errors = world.contact->sum_errors();
  for (std::size_t i = 0; i < deepest.size(); ++i) {
    const ContactSpec& contact = world.description.contacts[i];
    Overlap one{fmt::format("{} - {}", contact.first, contact.second), deepest[i], HUGE_VAL,
                contact.first == contact.second};
    if (errors[i]) {
      one.quadrature_error = errors[i]->largest();
      one.largest_share = errors[i]->largest_share();
    }
    if (one.deepest_m > 0.0 && one.of_itself)
      one.half_width_m = Overlap::kOwnShare * depth_within_itself(*world.find_body(contact.first));
    else if (one.deepest_m > 0.0)
      one.half_width_m = std::min(half_width(world, contact.first), half_width(world, contact.second));
    out.push_back(one);
  }
  return out;
}

std::vector<scene::Need> needs(const scene::Description& description) {
  return scene::needs(description, integrate::linear_solver_of(description.integrator));
}

store::Summary summarise(const World& world, const RunResult& result, double assemble_s) {
  store::Summary summary;
  summary.scene = world.description.name;
  summary.scene_source = world.description.source;
  summary.outcome = !result.status.ok() ? "failed" : result.stopped ? "interrupted" : "finished";
  summary.message = result.status.message;
  summary.provenance = full_provenance();
  add_options(summary.section("options"), world.description);
  if (const std::string& ordering = result.counters.solver.ordering; !ordering.empty())
    summary.section("options").values.emplace_back("ordering", ordering);
  add_sizes(summary.section("sizes"), world);
  add_models(summary, world.description);
  add_numbers<long>(summary.section("counts"), result);
  if (const long halvings = result.counters.most_halvings; halvings > 0)
    summary.section("sizes").values.emplace_back("smallest_part_of_a_step",
                                                 std::ldexp(1.0, -static_cast<int>(halvings)));
  summary.section("timings").values.emplace_back("assemble_s", assemble_s);
  add_numbers<double>(summary.section("timings"), result);
  // Vertices that tunnelled, one value per [[contact]].
  for (std::size_t i = 0; i < result.tunnelled.size(); ++i) {
    const ContactSpec& contact = world.description.contacts[i];
    summary.section("tunnelled")
        .values.emplace_back(contact.first + " - " + contact.second,
                             static_cast<long long>(result.tunnelled[i]));
  }
  add_energy(summary, result);
  add_real_time(summary, result);
  if (result.buzz_n || result.port) add_feel(summary.section("device"), result.buzz_n, result.port);
  add_more_hands(summary, world.description, result);
  add_tallies(summary, world);
  add_answers(summary, world);
  add_grasps(summary, world);
  add_jumps(summary, world);
  add_images(summary, world);
  add_pruning(summary, world);
  for (const scene::Need& need : needs(world.description))
    summary.section(need.used ? "in_use" : "left_out").values.emplace_back(need.part, need.why);
  for (const auto& [name, value] : counters::snapshot())
    summary.section("constructions").values.emplace_back(name, static_cast<long long>(value));
  return summary;
}

}  // namespace palpate::loop
