#include "scene/keys.h"

#include <algorithm>

namespace palpate::scene {
namespace {

const KeyTable<ObstacleSpec>& obstacle_keys() {
  static const KeyTable<ObstacleSpec> keys = {
      required(text("name", &ObstacleSpec::name)),
      required(text("type", &ObstacleSpec::type, {"plane", "sphere", "box", "cylinder"})),
      vec3("position_m", &ObstacleSpec::position_m),
      vec3("normal", &ObstacleSpec::normal),
      vec3("rotation_vector_rad", &ObstacleSpec::rotation_vector_rad),
      vec3("size_m", &ObstacleSpec::size_m, positive()),
      number("radius_m", &ObstacleSpec::radius_m, positive()),
      number("length_m", &ObstacleSpec::length_m, positive()),
  };
  return keys;
}

void read_between(const Value& value, ContactSpec& spec) {
  const std::vector<std::string> names = read_texts(value);
  if (names.size() != 2)
    refuse(place(value.node.source()), value.where,
           fmt::format("between must name two things, [\"ball\", \"floor\"], not {}", names.size()));
  spec.first = names[0];
  spec.second = names[1];
}

const KeyTable<ContactSpec>& contact_keys() {
  static const KeyTable<ContactSpec> keys = {
      required(Key<ContactSpec>{"between", read_between}),
      text("method", &ContactSpec::method, {"analytic", "gpu"}),
      number("stiffness_pa_m", &ContactSpec::stiffness_pa_m,
             positive("10 x Young's modulus / the size of the dent is a start")),
      number("damping_pa_s_m", &ContactSpec::damping_pa_s_m, at_least(0.0)),
      number("hunt_crossley_s_m", &ContactSpec::hunt_crossley_s_m, at_least(0.0)),
      text("law", &ContactSpec::law, {"kelvin_voigt", "hunt_crossley"}),
      number("onset_width_m", &ContactSpec::onset_width_m,
             at_least(0.0, "0 lets the pressure set in at once; a tenth of the depth is a smooth onset")),
      number("friction", &ContactSpec::friction, at_least(0.0)),
      number("friction_regularisation_m_s", &ContactSpec::friction_regularisation_m_s, positive()),
      number("candidate_gap_m", &ContactSpec::candidate_gap_m, at_least(0.0, "0 lets the mesh choose")),
      integer("pixels", &ContactSpec::pixels, closed(16, 4096)),
  };
  return keys;
}

const KeyTable<ToolSpec>& coupling_keys() {
  static const KeyTable<ToolSpec> keys = {
      number("stiffness_n_m", &ToolSpec::coupling_stiffness_n_m, at_least(0.0)),
      number("damping_n_s_m", &ToolSpec::coupling_damping_n_s_m, at_least(0.0)),
      number("rotational_stiffness_n_m_rad", &ToolSpec::coupling_rotational_stiffness_n_m_rad, at_least(0.0)),
      number("rotational_damping_n_m_s_rad", &ToolSpec::coupling_rotational_damping_n_m_s_rad, at_least(0.0)),
  };
  return keys;
}

const KeyTable<ToolSpec>& tool_keys() {
  static const KeyTable<ToolSpec> keys = {
      text("shape", &ToolSpec::shape, {"sphere", "mesh"}),
      number("radius_m", &ToolSpec::radius_m, positive()),
      table("mesh", &ToolSpec::mesh, mesh_keys()),
      number("mass_kg", &ToolSpec::mass_kg, positive()),
      vec3("inertia_kg_m2", &ToolSpec::inertia_kg_m2,
           at_least(0.0,
                    "it is the principal inertia about the centre of mass; [0, 0, 0] is a solid sphere's")),
      vec3("position_m", &ToolSpec::position_m),
      vec3("rotation_vector_rad", &ToolSpec::rotation_vector_rad),
      boolean("gravity", &ToolSpec::gravity),
      group("coupling", coupling_keys()),
      number("tick_s", &ToolSpec::tick_s, open(0.0, 0.1, "a haptic device asks for 0.001")),
      text("integrator", &ToolSpec::integrator),
  };
  return keys;
}

const KeyTable<DeviceSpec>& device_keys() {
  static const KeyTable<DeviceSpec> keys = {
      text("type", &DeviceSpec::type),
      tables("keyframe", &DeviceSpec::keyframes, keyframe_keys()),
      number("max_force_n", &DeviceSpec::max_force_n, positive("a desktop device gives 3.3")),
      number("max_torque_n_m", &DeviceSpec::max_torque_n_m, positive()),
      number("ramp_s", &DeviceSpec::ramp_s, at_least(0.0)),
  };
  return keys;
}

const KeyTable<CouplingSpec>& exchange_keys() {
  static const KeyTable<CouplingSpec> keys = {
      text("scheme", &CouplingSpec::scheme, {"partitioned", "monolithic"}),
      text("linearisation", &CouplingSpec::linearisation, {"condensed", "frozen"}),
      number("exchange_period_s", &CouplingSpec::exchange_period_s, positive("5 to 20 ms is usual")),
      number("contact_refresh_s", &CouplingSpec::contact_refresh_s, positive()),
  };
  return keys;
}

const KeyTable<IntegratorSpec>& integrator_keys() {
  static const KeyTable<IntegratorSpec> keys = {
      text("name", &IntegratorSpec::name),
      number("rtol", &IntegratorSpec::rtol,
             {.low = 0.0, .high = 1.0, .low_open = true, .remedy = "1e-3 is a good start"}),
      number("atol_q", &IntegratorSpec::atol_q, positive()),
      number("atol_u", &IntegratorSpec::atol_u, positive()),
      number("step_s", &IntegratorSpec::step_s, positive()),
      boolean("fixed_step", &IntegratorSpec::fixed_step),
      integer("factor_kept_steps", &IntegratorSpec::factor_kept_steps, at_least(1)),
      number("newton_rtol", &IntegratorSpec::newton_rtol,
             {.low = 0.0, .high = 1.0, .low_open = true, .remedy = "1e-8 is usual"}),
      number("spectral_radius", &IntegratorSpec::spectral_radius,
             closed(0.0, 1.0, "0 damps what the step cannot resolve at once, 1 not at all")),
      text("events", &IntegratorSpec::events, {"error-control", "root-finding"}),
      text("explicit_side", &IntegratorSpec::explicit_side, {"loads", "contact"}),
      text("indefinite", &IntegratorSpec::indefinite, {"project", "lu"}),
      number("linear_rtol", &IntegratorSpec::linear_rtol,
             {.low = 0.0, .high = 1.0, .low_open = true, .remedy = "1e-8 is usual"}),
      integer("max_order", &IntegratorSpec::max_order, closed(0, 12, "0 leaves the order to the method")),
      integer("max_steps", &IntegratorSpec::max_steps, at_least(1)),
      text("linear_solver", &IntegratorSpec::linear_solver),
      integer("threads", &IntegratorSpec::threads,
              closed(1, 64,
                     "of elements and of linear solvers that share their work; results do not depend on it")),
  };
  return keys;
}

const KeyTable<RecordSpec>& record_keys() {
  static const KeyTable<RecordSpec> keys = {
      boolean("states", &RecordSpec::states),
      number("state_period_s", &RecordSpec::state_period_s, positive()),
      boolean("forces", &RecordSpec::forces),
  };
  return keys;
}

/// A rung list `rtol = [...]` or `step_s = [...]`; both go into `values`, and `setting` says which it was.
Key<LadderSpec> rungs(const char* name) {
  return {name, [](const Value& value, LadderSpec& spec) {
            const std::string at = place(value.node.source());
            if (!spec.values.empty())
              refuse(at, value.where, fmt::format("{} and {} exclude each other", spec.setting, value.key));
            spec.setting = value.key;
            spec.values = read_numbers(value, positive());
            if (spec.values.empty())
              refuse(at, value.where, fmt::format("{} must list at least one number", value.key));
            for (std::size_t i = 1; i < spec.values.size(); ++i)
              if (spec.values[i] >= spec.values[i - 1])
                refuse(at, value.where,
                       fmt::format("{} must fall from the coarsest to the finest, but {} comes after {}",
                                   value.key, spec.values[i], spec.values[i - 1]));
          }};
}

const KeyTable<LadderSpec>& ladder_keys() {
  static const KeyTable<LadderSpec> keys = {required(text("integrator", &LadderSpec::integrator)),
                                            text("label", &LadderSpec::label), texts("set", &LadderSpec::set),
                                            rungs("rtol"), rungs("step_s")};
  return keys;
}

void read_methods(const Value& value, CompareSpec& spec) {
  const std::vector<std::string> known = {"analytic", "gpu"};
  spec.contact_methods = read_texts(value);
  for (const std::string& method : spec.contact_methods)
    if (std::find(known.begin(), known.end(), method) == known.end())
      refuse(place(value.node.source()), value.where,
             fmt::format("contact_methods holds the unknown method \"{}\"{}", method,
                         suggestion(method, known)));
}

const KeyTable<CompareSpec>& compare_keys() {
  static const KeyTable<CompareSpec> keys = {
      tables("ladder", &CompareSpec::ladders, ladder_keys()),
      numbers("exchange_periods_s", &CompareSpec::exchange_periods_s, positive()),
      numbers("refresh_periods_s", &CompareSpec::refresh_periods_s, positive()),
      text("reference", &CompareSpec::reference),
      number("reference_rtol", &CompareSpec::reference_rtol,
             closed(1e-13, 1e-2, "it must be tighter than every rung; 1e-9 is a good start")),
      text("reference_check", &CompareSpec::reference_check),
      number("reference_check_rtol", &CompareSpec::reference_check_rtol, closed(1e-13, 1e-2)),
      Key<CompareSpec>{"contact_methods", read_methods},
      number("duration_s", &CompareSpec::duration_s, at_least(0.0, "0 is the scene's own")),
  };
  return keys;
}

const KeyTable<Description>& scene_keys() {
  static const KeyTable<Description> keys = {
      required(text("name", &Description::name)),
      required(number("duration_s", &Description::duration_s, positive())),
      vec3("gravity_m_s2", &Description::gravity_m_s2),
  };
  return keys;
}

}  // namespace

const KeyTable<Description>& description_keys() {
  static const KeyTable<Description> keys = {
      required(group("scene", scene_keys())),
      tables("body", &Description::bodies, body_keys()),
      tables("bone", &Description::bones, bone_keys()),
      tables("obstacle", &Description::obstacles, obstacle_keys()),
      tables("contact", &Description::contacts, contact_keys()),
      table("tool", &Description::tool, tool_keys()),
      table("device", &Description::device, device_keys()),
      table("exchange", &Description::coupling, exchange_keys()),
      table("integrator", &Description::integrator, integrator_keys()),
      table("record", &Description::record, record_keys()),
      table("compare", &Description::compare, compare_keys()),
  };
  return keys;
}

}  // namespace palpate::scene
