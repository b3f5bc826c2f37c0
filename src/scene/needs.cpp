#include "scene/needs.h"
#include "palpate/core/named_enum.h"

#include <algorithm>

#include "palpate/core/error.h"
#include "palpate/scene/hands.h"
#include "scene/contact_sides.h"

namespace palpate::scene {
namespace {

template <class List, class Predicate>
int count_if(const List& list, Predicate predicate) {
  return static_cast<int>(std::count_if(list.begin(), list.end(), predicate));
}

void add_body_needs(const Description& d, const std::string& linear_solver, std::vector<Need>& out) {
  int fixed = 0, driven = 0, carried = 0, loads = 0;
  const int nodal = count_if(d.bodies, [](const auto& b) { return b.volumetric == Volumetric::kNodal; });
  for (const auto& body : d.bodies) {
    fixed += count_if(body.attachments, [](const auto& a) { return a.to.empty() && a.keyframes.empty(); });
    driven += count_if(body.attachments, [](const auto& a) { return !a.keyframes.empty(); });
    carried += count_if(body.attachments, [](const auto& a) { return !a.to.empty(); });
    loads += static_cast<int>(body.loads.size());
  }
  const bool any = !d.bodies.empty();
  const bool weight = any && !d.gravity_m_s2.isZero(0.0);
  out.push_back({"fem", any,
                 any ? fmt::format("{} soft {}", d.bodies.size(), d.bodies.size() == 1 ? "body" : "bodies")
                     : "no [[body]]"});
  out.push_back({"nodal dilatation", nodal > 0,
                 nodal > 0 ? fmt::format("{} [[body]] with volumetric = \"nodal\"", nodal)
                           : "no [[body]] with volumetric = \"nodal\""});
  const int skins = count_if(d.bodies, [](const auto& b) { return b.skin; });
  out.push_back(
      {"skin", skins > 0,
       skins > 0 ? fmt::format("{} [[body]] with skin = true", skins) : "no [[body]] with skin = true"});
  const int named = count_if(d.bodies, [](const auto& b) { return b.proxies; });
  const int proxies = count_if(d.bodies, [&](const auto& b) { return b.proxies && is_in_images(d, b.name); });
  out.push_back({"proxies", proxies > 0,
                 proxies > 0 ? fmt::format("{} [[body]] with proxies = true: contact in regions", proxies)
                 : named > 0 ? "no contact in image space of a [[body]] with proxies = true"
                             : "no [[body]] with proxies = true"});
  out.push_back(
      {"gravity", weight, weight ? "gravity_m_s2 is not zero" : "gravity_m_s2 is zero, or there is no body"});
  out.push_back({"fixed nodes", fixed > 0,
                 fixed > 0 ? fmt::format("{} [[body.attachment]] without keyframes", fixed)
                           : "no [[body.attachment]] without keyframes"});
  out.push_back({"driven nodes", driven > 0,
                 driven > 0 ? fmt::format("{} [[body.attachment]] with keyframes", driven)
                            : "no [[body.attachment.keyframe]]"});
  const int prescribed = count_if(d.bones, [](const auto&b) { return b.fixed || !b.keyframes.empty(); }),
            free = static_cast<int>(d.bones.size()) - prescribed;
  out.push_back({"carried nodes", carried > 0,
                 carried > 0 ? fmt::format("{} [[body.attachment]] to a bone or a tool", carried)
                             : "no [[body.attachment]] with to"});
  out.push_back({"rigid bones", free > 0,
                 free > 0
                     ? fmt::format("{} free [[bone]]: rigid-body unknowns in addition to the nodes", free)
                 : prescribed > 0 ? "every [[bone]] is fixed or has keyframes"
                                  : "no [[bone]]"});
  const int skeletons = count_if(d.bodies, [](const auto& b) { return b.skeleton.has_value(); });
  out.push_back(
      {"skeleton", skeletons > 0,
       skeletons > 0
           ? fmt::format("{} [body.skeleton]: bones of the model file, on joints by Simbody", skeletons)
           : "no [body.skeleton]"});
  int regions = 0;
  for (const auto& body : d.bodies) regions += static_cast<int>(body.regions.size());
  out.push_back({"materials by region", regions > 0,
                 regions > 0 ? fmt::format("{} [[body.region]]", regions)
                             : "no [[body.region]]: each body has one material"});
  int changes = 0;
  for (const auto& body : d.bodies) changes += static_cast<int>(body.changes.size());
  out.push_back({"material changes", changes > 0,
                 changes > 0 ? fmt::format("{} [[body.change]]", changes) : "no [[body.change]]"});
  out.push_back(
      {"loads", loads > 0, loads > 0 ? fmt::format("{} [[body.load]]", loads) : "no [[body.load]]"});
  const bool implicit = any && !linear_solver.empty();
  const std::string why =
      !any ? "no [[body]]"
           : fmt::format("integrator \"{}\" is {}", d.integrator.name, implicit ? "implicit" : "explicit");
  out.push_back({"tangent", implicit, why});
  out.push_back({"linear solver", implicit, implicit ? fmt::format("{}; \"{}\"", why, linear_solver) : why});
}

/// Returns whether a tool that is advanced by ticks carries nodes.
bool tools_carry(const Description& d) {
  const auto by_tool = [&](const AttachmentSpec& a) { return tool_named(d, a.to) != nullptr; };
  return !d.exchange.has_tools_in_state() &&
         count_if(d.bodies, [&](const auto& body) { return count_if(body.attachments, by_tool) > 0; }) > 0;
}

void add_contact_needs(const Description& d, std::vector<Need>& out) {
  const bool any = !d.contacts.empty();
  const int image = count_if(d.contacts, [](const ContactSpec&c) { return is_in_images(c); }),
            near = count_if(d.contacts, [](const ContactSpec&c) { return c.method == "distance"; });
  const int rubbing = count_if(d.contacts, [](const auto& c) { return c.friction > 0.0; });
  const int own = count_if(d.contacts, [](const auto& c) { return c.first == c.second; });
  const std::string no_image = any ? "every contact has exact gaps" : "no [[contact]]";
  const bool tied = tools_carry(d);
  out.push_back({"contact", any || tied,
                 any    ? fmt::format("{} [[contact]]", d.contacts.size())
                 : tied ? "no [[contact]], but springs to nodes that a tool carries"
                        : "no [[contact]]"});
  out.push_back({"friction", rubbing > 0,
                 rubbing > 0 ? fmt::format("{} [[contact]] with friction > 0", rubbing)
                             : "no contact with friction > 0"});
  out.push_back({"contact of a body with itself", own > 0,
                 own > 0 ? fmt::format("{} [[contact]] of a body with itself", own)
                 : any   ? "every [[contact]] is between two objects"
                         : "no [[contact]]"});
  out.push_back({"nearest points", near > 0,
                 near > 0 ? fmt::format("{} [[contact]] with method \"distance\"", near)
                 : any    ? "no contact has method \"distance\""
                          : "no [[contact]]"});
  out.push_back({"contact plane", image > 0,
                 image > 0 ? fmt::format("{} [[contact]] in image space", image) : no_image});
  out.push_back(
      {"gl", image > 0, image > 0 ? "method \"image\" rasterises" : no_image + "; pictures only on request"});
}

void add_haptic_needs(const Description& d, std::vector<Need>& out) {
  const bool tool = d.tool.has_value();
  out.push_back({"tool", tool,
                 tool ? fmt::format("[tool], {} under a virtual coupling, {}", name_of(d.tool->shape),
                                    name_of(d.exchange.scheme))
                      : "no [tool]"});
  out.push_back({"device", d.device.has_value(),
                 d.device ? fmt::format("[device], type \"{}\"", d.device->type) : "no [device]"});
  const std::size_t more = d.hands.size();
  out.push_back({"more hands", more > 0, more > 0 ? fmt::format("{} [[hand]]", more) : "no [[hand]]"});
  const bool in_state = tool && d.exchange.has_tools_in_state(),
             two_rates = tool && !in_state && !d.bodies.empty();
  const std::string one_system =
      fmt::format("scheme \"{}\": one integrator advances tool and bodies", name_of(d.exchange.scheme));
  out.push_back({"exchange", two_rates,
                 two_rates  ? fmt::format("tool ticks every {} s, exchange every {} s", d.tool->tick_s,
                                          d.exchange.exchange_period_s)
                 : in_state ? one_system
                            : "one rate only"});
  const bool touched = tools_carry(d) || count_if(d.contacts, [&](const auto& c) {
                                           return tool_named(d, c.second) && !tool_named(d, c.first);
                                         }) > 0;
  const bool points = two_rates && touched && d.exchange.linearisation == "points";
  out.push_back({"contact points", points,
                 points     ? "linearisation \"points\": bodies are reduced to their contact with the tool"
                 : in_state ? one_system
                 : !touched ? "no contact of a soft body with a tool"
                            : fmt::format("linearisation \"{}\"", d.exchange.linearisation)});
  const bool condensed = two_rates && touched && d.exchange.linearisation == "condensed";
  out.push_back({"condenser", condensed,
                 condensed
                     ? "linearisation \"condensed\": the bodies' step matrix is factored once per exchange"
                 : in_state ? one_system
                 : !touched ? "no contact of a soft body with a tool"
                            : fmt::format("linearisation \"{}\"", d.exchange.linearisation)});
  const std::vector<Hand> hands = hands_of(d);
  const auto grasps =
      std::find_if(hands.begin(), hands.end(), [](const Hand& h) { return h.tool->grasp_switch >= 0; });
  const bool grasp = grasps != hands.end();
  out.push_back({"grasp", grasp,
                 grasp    ? fmt::format("{}.grasp_switch = {}", grasps->tool_key, grasps->tool->grasp_switch)
                 : d.tool ? "no tool.grasp_switch"
                          : "no [tool]"});
  out.push_back({"exchange thread", false, "virtual time: everything runs sequentially in one thread"});
}

void add_output_needs(const Description& d, std::vector<Need>& out) {
  const bool states = d.record && d.record->states, forces = d.record && d.record->forces && d.tool;
  const std::string none = d.record ? "" : "no [record]";
  out.push_back({"run file", states,
                 states         ? fmt::format("[record] states, every {} s", d.record->state_period_s)
                 : none.empty() ? "[record] states = false"
                                : none});
  const bool any_bones =
      !d.bones.empty() || count_if(d.bodies, [](const auto& b) { return b.skeleton.has_value(); }) > 0;
  const bool bones = states && any_bones;
  out.push_back({"bone file", bones,
                 bones ? fmt::format("[record] states, {} [[bone]] and those of skeletons", d.bones.size())
                 : !none.empty() ? none
                 : !any_bones    ? "no [[bone]]"
                                 : "[record] states = false"});
  out.push_back({"force file", forces,
                 forces          ? "[record] forces, every tick"
                 : !none.empty() ? none
                 : d.tool        ? "[record] forces = false"
                                 : "no [tool]"});
  const bool energy = d.record && d.record->energy;
  out.push_back({"energy file", energy,
                 energy         ? "[record] energy, every period: energies and works"
                 : none.empty() ? "[record] energy = false"
                                : none});
  const std::size_t ladders = d.compare.ladders.size();
  out.push_back({"compare", ladders > 0,
                 ladders > 0 ? fmt::format("{} [[compare.ladder]], for `palpate compare` only", ladders)
                             : "no [[compare.ladder]]"});
}

}  // namespace

std::vector<Need> needs(const Description& description, const std::string& linear_solver) {
  std::vector<Need> out;
  add_body_needs(description, linear_solver, out);
  add_contact_needs(description, out);
  add_haptic_needs(description, out);
  add_output_needs(description, out);
  return out;
}

}  // namespace palpate::scene
