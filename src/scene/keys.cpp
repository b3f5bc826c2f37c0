#include "scene/keys.h"

#include <algorithm>

namespace palpate::scene {
namespace {

/// Keys of every obstacle; the other keys depend on the type, by the registry of obstacles (kinds.cpp).
const KeyTable<ObstacleSpec>& obstacle_keys() {
  static const KeyTable<ObstacleSpec> keys = {
      required(text("name", &ObstacleSpec::name, {}, "what [[contact]] calls it")),
      required(text("type", &ObstacleSpec::type, {}, "its shape")),
  };
  return keys;
}

/// Reads the keys of obstacle_keys() into the spec, and all others into its shape: check_kinds() checks them.
void read_obstacles(const Value& value, Description& d) {
  for (const toml::table* one : read_table_array(value)) {
    ObstacleSpec& spec = d.obstacles.emplace_back();
    const std::string where = label(value.where, value.key, *one, d.obstacles.size() - 1);
    for (const auto& key : obstacle_keys()) {
      const toml::node* node = one->get(key.name);
      if (!node) refuse_missing(*one, where, key.name);
      key.read(Value{*node, where, key.name}, spec);
    }
    const Names own = names_of(obstacle_keys());
    for (const auto& [key, node] : *one) {
      if (std::find(own.begin(), own.end(), key.str()) != own.end()) continue;
      if (const auto setting = setting_of(node)) spec.shape.emplace(std::string(key.str()), *setting);
    }
  }
}

void read_between(const Value& value, ContactSpec& spec) {
  const std::vector<std::string> names = read_texts(value);
  if (names.size() != 2)
    refuse(location(value.node.source()), value.where,
           fmt::format("between must name two things, [\"ball\", \"floor\"], not {}", names.size()));
  spec.first = names[0];
  spec.second = names[1];
}

const KeyTable<ContactSpec>& contact_keys() {
  using Ranges = ContactRanges;
  static const KeyTable<ContactSpec> keys = {
      required(own_key<ContactSpec>(
          "between", read_between, "list of texts", "",
          "two names, in any order: bodies, \"tool\", other hands, obstacles; a body twice: with itself")),
      text("method", &ContactSpec::method, {}, "how gaps are found"),
      text("spring", &ContactSpec::spring, {},
           "per_area: forces do not depend on the mesh; per_point: the same spring at each colliding vertex"),
      number("stiffness_pa_m", &ContactSpec::stiffness_pa_m, Ranges::stiffness_pa_m,
             "pressure per depth of penetration"),
      number("stiffness_n_m", &ContactSpec::stiffness_n_m, Ranges::stiffness_n_m,
             "force of a colliding vertex per depth of penetration"),
      number("damping_pa_s_m", &ContactSpec::damping_pa_s_m, Ranges::damping_pa_s_m,
             "pressure per rate of penetration"),
      number("damping_n_s_m", &ContactSpec::damping_n_s_m, Ranges::damping_n_s_m,
             "force of a colliding vertex per rate of penetration"),
      number("hunt_crossley_s_m", &ContactSpec::hunt_crossley_s_m, Ranges::hunt_crossley_s_m,
             "damping over stiffness: the pressure times (1 + 3/2 c rate)"),
      text("law", &ContactSpec::law, {}, "pressure by depth and rate"),
      number("onset_width_m", &ContactSpec::onset_width_m, Ranges::onset_width_m,
             "depth over which the pressure sets in smoothly; 0: at once, with a kink"),
      number("friction", &ContactSpec::friction, Ranges::friction, "coefficient of Coulomb friction"),
      unless("3e-4 sqrt(g L), L the tool's length, else the smaller body's; g 9.81 without gravity",
             number("friction_regularisation_m_s", &ContactSpec::friction_regularisation_m_s,
                    Ranges::friction_regularisation_m_s, "sliding speed below which friction is viscous")),
      boolean("friction_anchors", &ContactSpec::friction_anchors,
              "what sticks is held by springs between material points (not between rigid things)"),
      text("friction_tangent", &ContactSpec::friction_tangent, {"auto", "full", "secant", "symmetric"},
           "symmetric, secant: without its change by pressure; secant: of a step's end, by repeated solves"),
      number("candidate_gap_m", &ContactSpec::candidate_gap_m, Ranges::candidate_gap_m,
             "samples with a smaller positive gap are kept as well; 0: chosen from the mesh"),
      integer("pixels", &ContactSpec::pixels, Ranges::pixels, "longer edge of the image"),
      number("quadrature_error", &ContactSpec::quadrature_error, Ranges::quadrature_error,
             "of nearest points: what they may err in the force, relative; chooses how many there are"),
  };
  return keys;
}

const KeyTable<VirtualCouplingSpec>& coupling_keys() {
  static const KeyTable<VirtualCouplingSpec> keys = {
      number("stiffness_n_m", &VirtualCouplingSpec::stiffness_n_m, ToolRanges::coupling,
             "spring between handle and tool"),
      number("damping_n_s_m", &VirtualCouplingSpec::damping_n_s_m, ToolRanges::coupling,
             "damper between handle and tool"),
      number("rotational_stiffness_n_m_rad", &VirtualCouplingSpec::rotational_stiffness_n_m_rad,
             ToolRanges::coupling, "torsion spring between handle and tool"),
      number("rotational_damping_n_m_s_rad", &VirtualCouplingSpec::rotational_damping_n_m_s_rad,
             ToolRanges::coupling, "torsion damper between handle and tool"),
  };
  return keys;
}

const KeyTable<ToolSpec>& tool_keys() {
  static const KeyTable<ToolSpec> keys = {
      text("shape", &ToolSpec::shape, {"sphere", "mesh"}, "a ball with exact gaps, or any closed surface"),
      number("radius_m", &ToolSpec::radius_m, ToolRanges::radius_m, "of shape = \"sphere\""),
      table("mesh", &ToolSpec::mesh, mesh_keys(),
            "closed surface of shape = \"mesh\", in the tool's own axes"),
      number("mass_kg", &ToolSpec::mass_kg, positive(), "mass of the tool"),
      vec3("inertia_kg_m2", &ToolSpec::inertia_kg_m2,
           at_least(0.0,
                    "it is the principal inertia about the centre of mass; [0, 0, 0] is a solid sphere's"),
           "principal inertia about the centre of mass; [0, 0, 0]: a solid sphere's"),
      vec3("position_m", &ToolSpec::position_m, any(), "centre of mass at the start"),
      vec3("rotation_vector_rad", &ToolSpec::rotation_vector_rad, any(),
           "orientation at the start: along the axis, as long as the angle"),
      boolean("gravity", &ToolSpec::gravity, "whether the tool has weight; a device holds its own"),
      table("coupling", &ToolSpec::coupling, coupling_keys(),
            "virtual coupling: the spring and damper that pull the tool after the handle"),
      number("tick_s", &ToolSpec::tick_s, ToolRanges::tick_s,
             "period of the tool's own steps and of the force on the hand"),
      text("integrator", &ToolSpec::integrator, {}, "of the tool's own steps: palpate list tool-integrators"),
      integer("grasp_switch", &ToolSpec::grasp_switch, ToolRanges::grasp_switch,
              "switch of the handle that grasps what presses on the tool; -1: none"),
  };
  return keys;
}

/// Marks a table as documented elsewhere: its keys are not listed again.
Key<HandSpec> as_elsewhere(Key<HandSpec> key) {
  key.children.clear();
  return required(std::move(key));
}

const KeyTable<HandSpec>& hand_keys() {
  static const KeyTable<HandSpec> keys = {
      required(text("name", &HandSpec::name, {}, "what [[contact]] calls its tool")),
      as_elsewhere(table("tool", &HandSpec::tool, tool_keys(), "its tool; the keys of [tool]")),
      as_elsewhere(table("device", &HandSpec::device, device_keys(), "its device; the keys of [device]")),
  };
  return keys;
}

const KeyTable<CosimulationSpec>& exchange_keys() {
  static const KeyTable<CosimulationSpec> keys = {
      text("scheme", &CosimulationSpec::scheme, {"partitioned", "monolithic"},
           "tool and bodies step by themselves and exchange forces, or are one system"),
      text("linearisation", &CosimulationSpec::linearisation, {"points", "condensed", "frozen"},
           "what the tool feels between exchanges: points of contact and the bodies' answer, or lines"),
      number("linearisation_error", &CosimulationSpec::linearisation_error,
             Range::closed(0.0, 0.5, "0 factors the step matrix"),
             "\"points\": by how much the bodies may answer more stiffly than they do, relative"),
      number("exchange_period_s", &CosimulationSpec::exchange_period_s, positive("5 to 20 ms is usual"),
             "time between exchanges; a whole number of ticks"),
      unless("exchange_period_s",
             number("contact_refresh_s", &CosimulationSpec::contact_refresh_s, positive(),
                    "time between searches for contact; a whole fraction of the period")),
      text("tunnelling", &CosimulationSpec::tunnelling, {"report", "substep"},
           "bodies that may go through each other between two refreshes: count what did, or refresh sooner"),
      number("shortest_refresh_s", &CosimulationSpec::shortest_refresh_s, positive(),
             "\"substep\" refreshes no sooner than this"),
      integer("latency_ticks", &CosimulationSpec::latency_ticks, at_least(0),
              "ticks from an exchange to the first that uses its result, in virtual time; up to ten periods"),
  };
  return keys;
}

const KeyTable<IntegratorSpec>& integrator_keys() {
  using Ranges = IntegratorRanges;
  static const KeyTable<IntegratorSpec> keys = {
      text("name", &IntegratorSpec::name, {}, "the method: palpate list integrators"),
      number("rtol", &IntegratorSpec::rtol, Ranges::rtol,
             "relative tolerance of error control; what a step is held to stands in the summary"),
      number("atol_q", &IntegratorSpec::atol_q, Ranges::atol_q,
             "absolute tolerance of positions: this times rtol times the body's size"),
      number("atol_u", &IntegratorSpec::atol_u, Ranges::atol_u,
             "absolute tolerance of velocities: this times rtol times the body's wave speed"),
      number("step_s", &IntegratorSpec::step_s, Ranges::step_s, "length of a fixed step"),
      boolean("fixed_step", &IntegratorSpec::fixed_step, "steps of step_s in place of error control"),
      integer("factor_kept_steps", &IntegratorSpec::factor_kept_steps, Ranges::factor_kept_steps,
              "steps that one factor serves; 1: full Newton"),
      number("newton_rtol", &IntegratorSpec::newton_rtol, Ranges::newton_rtol,
             "Newton ends when its correction, in the units of rtol, is below this"),
      number("spectral_radius", &IntegratorSpec::spectral_radius, Ranges::spectral_radius,
             "amplification of what the step cannot resolve: 0 damps it at once, 1 not at all"),
      text("events", &IntegratorSpec::events, {"error-control", "root-finding"},
           "how a kink of the force is met: by short steps, or by a restart at it"),
      text("explicit_side", &IntegratorSpec::explicit_side, {"loads", "contact"},
           "what is explicit: loads, or contact and loads"),
      text("indefinite", &IntegratorSpec::indefinite, {"project", "lu"},
           "a step matrix that is not positive definite: projected tangents first, or LU at once"),
      number("linear_rtol", &IntegratorSpec::linear_rtol, Ranges::linear_rtol,
             "relative accuracy of an iterative linear solver"),
      integer("max_order", &IntegratorSpec::max_order, Ranges::max_order,
              "cap on the order; 0 leaves it to the method"),
      integer("max_steps", &IntegratorSpec::max_steps, Ranges::max_steps,
              "internal steps between two outputs before giving up"),
      unless("the method's own", text("linear_solver", &IntegratorSpec::linear_solver, {},
                                      "what solves with the step matrix: palpate list linear-solvers")),
      integer("threads", &IntegratorSpec::threads, Ranges::threads,
              "threads that share the work; results do not depend on it"),
  };
  return keys;
}

const KeyTable<RecordSpec>& record_keys() {
  static const KeyTable<RecordSpec> keys = {
      boolean("states", &RecordSpec::states, "states of the bodies as a time series, run.vtkhdf"),
      number("state_period_s", &RecordSpec::state_period_s, positive(),
             "time between states, rounded to whole exchange periods"),
      boolean("forces", &RecordSpec::forces, "force and torque on the hand, a line a tick, force.csv"),
      boolean("energy", &RecordSpec::energy,
              "energies, works and what was dissipated, a line an exchange period or refresh, energy.csv"),
  };
  return keys;
}

/// Refinement sequence `rtol = [...]` or `step_s = [...]`; both fill `values`, and `setting` holds which it
/// was.
Key<LadderSpec> rungs(const char* name, const char* meaning) {
  return own_key<LadderSpec>(
      name,
      [](const Value& value, LadderSpec& spec) {
        const std::string at = location(value.node.source());
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
      },
      "list of numbers", "", meaning);
}

const KeyTable<LadderSpec>& ladder_keys() {
  static const KeyTable<LadderSpec> keys = {
      required(text("integrator", &LadderSpec::integrator, {}, "the method: palpate list integrators")),
      unless("the integrator's name", text("label", &LadderSpec::label, {}, "what reports call this ladder")),
      texts("set", &LadderSpec::set, "what else is changed in the scene: \"KEY=VALUE\", as for --set"),
      rungs("rtol",
            "tolerances, loosest to tightest; of methods with error control; left out: from 0.1 down"),
      rungs("step_s",
            "steps, longest to shortest; of methods with fixed steps; left out: halved from a period on")};
  return keys;
}

void read_methods(const Value& value, CompareSpec& spec) { spec.contact_methods = read_texts(value); }

const KeyTable<HapticCompareSpec>& haptic_compare_keys() {
  using Spec = HapticCompareSpec;
  static const KeyTable<Spec> keys = {
      text("reference", &Spec::reference, {}, "the integrator of tool and bodies as one system"),
      text("reference_check", &Spec::reference_check, {},
           "the integrator of another family that checks it, twice as coarse; left out: one is chosen"),
      number("reference_rtol", &Spec::reference_rtol, closed(1e-13, 1e-2),
             "relative tolerance of the reference, where it has error control"),
      number("reference_step_s", &Spec::reference_step_s, positive(),
             "step of the reference, where it takes fixed ones"),
      number("reference_refresh_s", &Spec::reference_refresh_s, positive(), "its contact refresh"),
      numbers("exchange_periods_s", &Spec::exchange_periods_s, positive(), "exchange periods to compare"),
      numbers("ticks_s", &Spec::ticks_s, ToolRanges::tick_s, "ticks of the tool to compare"),
      numbers("pixels", &Spec::pixels, ContactRanges::pixels,
              "of the images of the tool's contacts, where it has any"),
      numbers("element_sizes_m", &Spec::element_sizes_m, positive(),
              "of every body that a generator meshes; another mesh is another body"),
      texts("integrators", &Spec::integrators, "of the bodies, at the scene's own tolerance or step"),
      unless("every one", texts("linearisations", &Spec::linearisations, "values of exchange.linearisation")),
  };
  return keys;
}

const KeyTable<CompareSpec>& compare_keys() {
  static const KeyTable<CompareSpec> keys = {
      tables("ladder", &CompareSpec::ladders, ladder_keys(),
             "one integrator over several tolerances or steps"),
      numbers("exchange_periods_s", &CompareSpec::exchange_periods_s, positive(),
              "for the chart of the exchange period's own error"),
      numbers("refresh_periods_s", &CompareSpec::refresh_periods_s, positive(),
              "contact refreshes at which the price of restarts is counted"),
      text("reference", &CompareSpec::reference, {}, "the integrator that makes the reference"),
      number("reference_rtol", &CompareSpec::reference_rtol,
             closed(1e-13, 1e-2, "it must be tighter than every rung; 1e-9 is a good start"),
             "relative tolerance of the reference"),
      text("reference_check", &CompareSpec::reference_check, {},
           "the integrator of another family that checks the reference"),
      number("reference_check_rtol", &CompareSpec::reference_check_rtol, closed(1e-13, 1e-2),
             "relative tolerance of the check"),
      own_key<CompareSpec>("contact_methods", read_methods, "list of texts", "",
                           "ways to find the tool's contact, each compared with the first"),
      number("duration_s", &CompareSpec::duration_s, at_least(0.0, "0 is the scene's own"),
             "simulated time of a comparison; 0: the scene's own"),
      table("haptic", &CompareSpec::haptic, haptic_compare_keys(),
            "force on the hand against tool and bodies as one system: palpate compare --haptic"),
  };
  return keys;
}

const KeyTable<Description>& scene_keys() {
  static const KeyTable<Description> keys = {
      required(text("name", &Description::name, {}, "what titles and reports call the scene")),
      required(number("duration_s", &Description::duration_s, positive(), "simulated time")),
      vec3("gravity_m_s2", &Description::gravity_m_s2, any(), "acceleration of free fall"),
  };
  return keys;
}

Key<Description> obstacle_table() {
  Key<Description> key =
      own_key<Description>("obstacle", read_obstacles, "tables", "", "a rigid shape fixed in the world");
  key.children = rows_of("obstacle", obstacle_keys());
  return key;
}

}  // namespace

const KeyTable<Description>& description_keys() {
  static const KeyTable<Description> keys = {
      required(group("scene", scene_keys(), "what is simulated, and for how long")),
      tables("body", &Description::bodies, body_keys(), "a soft body"),
      tables("bone", &Description::bones, bone_keys(), "a rigid body that carries nodes of soft ones"),
      obstacle_table(),
      tables("contact", &Description::contacts, contact_keys(), "a pair that may touch"),
      table("tool", &Description::tool, tool_keys(), "a rigid tool that the hand moves"),
      table("device", &Description::device, device_keys(), "the haptic device in the hand"),
      tables("hand", &Description::hands, hand_keys(), "one more hand, with a tool and a device of its own"),
      table("exchange", &Description::exchange, exchange_keys(),
            "how tool and bodies are simulated together"),
      table("integrator", &Description::integrator, integrator_keys(), "how the bodies step in time"),
      table("record", &Description::record, record_keys(), "what is kept of a run; without it nothing is"),
      table("compare", &Description::compare, compare_keys(), "what palpate compare does with the scene"),
  };
  return keys;
}

}  // namespace palpate::scene
