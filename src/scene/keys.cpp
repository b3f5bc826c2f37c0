#include "scene/keys.h"

#include <algorithm>

namespace palpate::scene {
namespace {

/// Keys of every obstacle; the other keys depend on the type, by the registry of obstacles (check_kinds.cpp).
const KeyTable<ObstacleSpec>& obstacle_keys() {
  static const KeyTable<ObstacleSpec> keys = {
      required(text("name", &ObstacleSpec::name, {}, "name used in [[contact]]")),
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
           fmt::format("between must list two names, as in [\"ball\", \"floor\"], not {}", names.size()));
  spec.first = names[0];
  spec.second = names[1];
}

const KeyTable<ContactSpec>& contact_keys() {
  using Ranges = ContactRanges;
  static const KeyTable<ContactSpec> keys = {
      required(own_key<ContactSpec>("between", read_between, "list of texts", "",
                                    "two names in any order: bodies, \"tool\", other hands, obstacles; the "
                                    "same body twice: self-contact")),
      text("method", &ContactSpec::method, {}, "how gaps are computed"),
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
             "ratio c of damping to stiffness: the pressure is multiplied by (1 + 3/2 c rate)"),
      text("law", &ContactSpec::law, {}, "law of the pressure as a function of depth and rate"),
      number("onset_width_m", &ContactSpec::onset_width_m, Ranges::onset_width_m,
             "depth over which the pressure sets in smoothly; 0: abruptly, with a kink"),
      number("friction", &ContactSpec::friction, Ranges::friction, "coefficient of Coulomb friction"),
      unless(
          "3e-4 sqrt(g L), with L the length of the tool or of the smaller body; without gravity g is 9.81",
          number("friction_regularisation_m_s", &ContactSpec::friction_regularisation_m_s,
                 Ranges::friction_regularisation_m_s, "sliding speed below which friction is viscous")),
      boolean("friction_anchors", &ContactSpec::friction_anchors,
              "hold sticking contact by springs between material points (not between rigid objects)"),
      option("friction_tangent", &ContactSpec::friction_tangent,
             "symmetric, secant: no derivative by pressure; secant: at the step's end, by repeated solves"),
      number("candidate_gap_m", &ContactSpec::candidate_gap_m, Ranges::candidate_gap_m,
             "samples with a positive gap below this are kept as candidates; 0: chosen from the mesh"),
      integer("pixels", &ContactSpec::pixels, Ranges::pixels, "pixels along the longer edge of the image"),
      number("quadrature_error", &ContactSpec::quadrature_error, Ranges::quadrature_error,
             "acceptable relative error of the force by nearest points; determines their number"),
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
      option("shape", &ToolSpec::shape, "a ball with exact gaps, or any closed surface"),
      number("radius_m", &ToolSpec::radius_m, ToolRanges::radius_m, "radius for shape = \"sphere\""),
      table("mesh", &ToolSpec::mesh, mesh_keys(), "closed surface for shape = \"mesh\", in the tool's frame"),
      number("mass_kg", &ToolSpec::mass_kg, positive(), "mass of the tool"),
      vec3("inertia_kg_m2", &ToolSpec::inertia_kg_m2,
           at_least(
               0.0,
               "it is the principal inertia about the centre of mass; [0, 0, 0] is that of a solid sphere"),
           "principal inertia about the centre of mass; [0, 0, 0]: that of a solid sphere"),
      vec3("position_m", &ToolSpec::position_m, any(), "initial position of the centre of mass"),
      vec3("rotation_vector_rad", &ToolSpec::rotation_vector_rad, any(),
           "initial orientation, as rotation axis times angle"),
      option("start", &ToolSpec::start,
             "placed: at position_m; touching: moved along start_direction until it touches, keyframes too"),
      vec3("start_direction", &ToolSpec::start_direction, any(),
           "direction of that motion, of any length, for start = \"touching\""),
      boolean("gravity", &ToolSpec::gravity,
              "whether gravity acts on the tool; off, as a device carries its weight"),
      table("coupling", &ToolSpec::coupling, coupling_keys(),
            "virtual coupling: spring and damper between handle and tool"),
      number("tick_s", &ToolSpec::tick_s, ToolRanges::tick_s,
             "period of the tool's steps and of the force output to the hand"),
      text("integrator", &ToolSpec::integrator, {}, "integrator of the tool: palpate list tool-integrators"),
      integer("grasp_switch", &ToolSpec::grasp_switch, ToolRanges::grasp_switch,
              "switch of the handle with which the tool grasps bodies that it touches; -1: none"),
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
      required(text("name", &HandSpec::name, {}, "name of its tool in [[contact]]")),
      as_elsewhere(table("tool", &HandSpec::tool, tool_keys(), "tool of this hand, with the keys of [tool]")),
      as_elsewhere(table("device", &HandSpec::device, device_keys(),
                         "device of this hand, with the keys of [device]")),
  };
  return keys;
}

const KeyTable<CosimulationSpec>& exchange_keys() {
  static const KeyTable<CosimulationSpec> keys = {
      option("scheme", &CosimulationSpec::scheme,
             "tool and bodies in two rates, as one system, or as one system stepped once per tick"),
      text("linearisation", &CosimulationSpec::linearisation, {"points", "condensed", "frozen"},
           "contact model between exchanges: contact points with the bodies' response, or a linear force "
           "model"),
      number("linearisation_error", &CosimulationSpec::linearisation_error,
             Range::closed(0.0, 0.5, "0 factors the step matrix"),
             "\"points\": acceptable relative error by which the reduced bodies are too stiff"),
      number("exchange_period_s", &CosimulationSpec::exchange_period_s, positive("5 to 20 ms is usual"),
             "time between exchanges; a whole number of ticks"),
      unless("exchange_period_s",
             number("contact_refresh_s", &CosimulationSpec::contact_refresh_s, positive(),
                    "time between searches for contact; the exchange period divided by a whole number")),
      option("tunnelling", &CosimulationSpec::tunnelling,
             "bodies that may pass through each other between two refreshes: report them, or refresh sooner"),
      number("shortest_refresh_s", &CosimulationSpec::shortest_refresh_s, positive(),
             "shortest time between two refreshes for \"substep\""),
      integer(
          "latency_ticks", &CosimulationSpec::latency_ticks, at_least(0),
          "ticks from an exchange to the first that uses its result, in virtual time; at most ten periods"),
  };
  return keys;
}

const KeyTable<IntegratorSpec>& integrator_keys() {
  using Ranges = IntegratorRanges;
  static const KeyTable<IntegratorSpec> keys = {
      text("name", &IntegratorSpec::name, {}, "the method: palpate list integrators"),
      number("rtol", &IntegratorSpec::rtol, Ranges::rtol,
             "relative tolerance of error control; summary.json has the resulting error limit per step"),
      number("atol_q", &IntegratorSpec::atol_q, Ranges::atol_q,
             "absolute tolerance of positions: this times rtol times the body's size"),
      number("atol_u", &IntegratorSpec::atol_u, Ranges::atol_u,
             "absolute tolerance of velocities: this times rtol times the body's wave speed"),
      number("step_s", &IntegratorSpec::step_s, Ranges::step_s, "length of a fixed step"),
      boolean("fixed_step", &IntegratorSpec::fixed_step, "take steps of step_s instead of error control"),
      integer("factor_kept_steps", &IntegratorSpec::factor_kept_steps, Ranges::factor_kept_steps,
              "steps that share one factorisation; 1: full Newton"),
      number("newton_rtol", &IntegratorSpec::newton_rtol, Ranges::newton_rtol,
             "Newton stops when its correction, in units of rtol, is below this"),
      number("spectral_radius", &IntegratorSpec::spectral_radius, Ranges::spectral_radius,
             "spectral radius at infinite frequency: 0 damps unresolved modes in one step, 1 not at all"),
      option("events", &IntegratorSpec::events,
             "treatment of kinks of the force: short steps, or a restart at the kink"),
      option("explicit_side", &IntegratorSpec::explicit_side,
             "forces integrated explicitly: loads, or contact and loads"),
      option("indefinite", &IntegratorSpec::indefinite,
             "for a step matrix that is not positive definite: projected tangents first, or LU at once"),
      number("linear_rtol", &IntegratorSpec::linear_rtol, Ranges::linear_rtol,
             "relative accuracy of an iterative linear solver"),
      integer("max_order", &IntegratorSpec::max_order, Ranges::max_order,
              "maximum order; 0: that of the method"),
      integer("max_steps", &IntegratorSpec::max_steps, Ranges::max_steps,
              "maximum number of internal steps between two outputs"),
      unless("chosen by the method", text("linear_solver", &IntegratorSpec::linear_solver, {},
                                          "solver for the step matrix: palpate list linear-solvers")),
      integer("threads", &IntegratorSpec::threads, Ranges::threads,
              "number of threads; results do not depend on it"),
  };
  return keys;
}

const KeyTable<RecordSpec>& record_keys() {
  static const KeyTable<RecordSpec> keys = {
      boolean("states", &RecordSpec::states, "states of the bodies as a time series, run.vtkhdf"),
      number("state_period_s", &RecordSpec::state_period_s, positive(),
             "time between states, rounded to whole exchange periods"),
      boolean("forces", &RecordSpec::forces, "force and torque on the hand, one line per tick, force.csv"),
      boolean("energy", &RecordSpec::energy,
              "energies, work and dissipation, one line per exchange period or refresh, energy.csv"),
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
                   fmt::format("{} must decrease from the coarsest to the finest, but {} comes after {}",
                               value.key, spec.values[i], spec.values[i - 1]));
      },
      "list of numbers", "", meaning);
}

const KeyTable<LadderSpec>& ladder_keys() {
  static const KeyTable<LadderSpec> keys = {
      required(text("integrator", &LadderSpec::integrator, {}, "the method: palpate list integrators")),
      unless("the integrator's name",
             text("label", &LadderSpec::label, {}, "name of this sequence in reports")),
      texts("set", &LadderSpec::set, "further changes to the scene: \"KEY=VALUE\", as for --set"),
      rungs("rtol", "tolerances of a method with error control, loosest first; if omitted: from 0.1 down"),
      rungs("step_s",
            "steps of a method with fixed steps, longest first; if omitted: one period, halved repeatedly")};
  return keys;
}

void read_methods(const Value& value, CompareSpec& spec) { spec.contact_methods = read_texts(value); }

const KeyTable<HapticCompareSpec>& haptic_compare_keys() {
  using Spec = HapticCompareSpec;
  static const KeyTable<Spec> keys = {
      text("reference", &Spec::reference, {}, "integrator of the monolithic reference"),
      text("reference_check", &Spec::reference_check, {},
           "integrator of another family that checks the reference, twice as coarse; if omitted: chosen"),
      number("reference_rtol", &Spec::reference_rtol, closed(1e-13, 1e-2),
             "relative tolerance of the reference, if it has error control"),
      number("reference_step_s", &Spec::reference_step_s, positive(),
             "step of the reference, if it takes fixed steps"),
      number("reference_refresh_s", &Spec::reference_refresh_s, positive(),
             "contact refresh period of the reference"),
      numbers("exchange_periods_s", &Spec::exchange_periods_s, positive(), "exchange periods to compare"),
      numbers("ticks_s", &Spec::ticks_s, ToolRanges::tick_s, "tick periods of the tool to compare"),
      numbers("pixels", &Spec::pixels, ContactRanges::pixels,
              "image sizes to compare, for contacts of the tool in image space"),
      numbers("element_sizes_m", &Spec::element_sizes_m, positive(),
              "element sizes of all generated meshes; a different mesh is a different body"),
      texts("integrators", &Spec::integrators, "integrators of the bodies, at the scene's tolerance or step"),
      unless("all",
             texts("linearisations", &Spec::linearisations, "values of exchange.linearisation to compare")),
  };
  return keys;
}

const KeyTable<CompareSpec>& compare_keys() {
  static const KeyTable<CompareSpec> keys = {
      tables("ladder", &CompareSpec::ladders, ladder_keys(), "one integrator at several tolerances or steps"),
      numbers("exchange_periods_s", &CompareSpec::exchange_periods_s, positive(),
              "exchange periods for the chart of their error"),
      numbers("refresh_periods_s", &CompareSpec::refresh_periods_s, positive(),
              "contact refresh periods at which the cost of restarts is measured"),
      text("reference", &CompareSpec::reference, {}, "integrator of the reference"),
      number("reference_rtol", &CompareSpec::reference_rtol,
             closed(1e-13, 1e-2, "it must be tighter than every compared tolerance; 1e-9 is a good start"),
             "relative tolerance of the reference"),
      text("reference_check", &CompareSpec::reference_check, {},
           "integrator of another family that checks the reference"),
      number("reference_check_rtol", &CompareSpec::reference_check_rtol, closed(1e-13, 1e-2),
             "relative tolerance of the check"),
      own_key<CompareSpec>("contact_methods", read_methods, "list of texts", "",
                           "contact methods of the tool, each compared with the first"),
      number("duration_s", &CompareSpec::duration_s, at_least(0.0, "0 is that of the scene"),
             "simulated time of a comparison; 0: that of the scene"),
      table("haptic", &CompareSpec::haptic, haptic_compare_keys(),
            "error of the force on the hand against the monolithic solution: palpate compare --haptic"),
  };
  return keys;
}

const KeyTable<Description>& scene_keys() {
  static const KeyTable<Description> keys = {
      required(text("name", &Description::name, {}, "name of the scene in titles and reports")),
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
      required(group("scene", scene_keys(), "name, duration and gravity of the simulation")),
      tables("body", &Description::bodies, body_keys(), "a soft body"),
      tables("bone", &Description::bones, bone_keys(), "a rigid body that carries nodes of soft ones"),
      obstacle_table(),
      tables("contact", &Description::contacts, contact_keys(), "a pair of objects that may touch"),
      table("tool", &Description::tool, tool_keys(), "a rigid tool that the hand moves"),
      table("device", &Description::device, device_keys(), "the haptic device in the hand"),
      tables("hand", &Description::hands, hand_keys(), "an additional hand, with its tool and device"),
      table("exchange", &Description::exchange, exchange_keys(), "co-simulation of tool and bodies"),
      table("integrator", &Description::integrator, integrator_keys(), "time integration of the bodies"),
      table("record", &Description::record, record_keys(),
            "time series that a run records; without this table, none"),
      table("compare", &Description::compare, compare_keys(), "settings of palpate compare for this scene"),
      table("view", &Description::view, view_keys(), "view of pictures, movies and pages"),
  };
  return keys;
}

}  // namespace palpate::scene
