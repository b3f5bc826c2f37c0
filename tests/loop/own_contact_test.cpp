// Self-contact in scenes: two blocks of one body collide as two bodies do; arms on scripted bones close with
// any integrator and linear solver.
#include <gtest/gtest.h>

#include "contact/bent_bar.h"
#include "contact/block_model.h"
#include "contact/sources.h"
#include "contact/together.h"
#include "core/counters.h"
#include "loop/penetration.h"
#include "loop/scene_checks.h"
#include "loop/small_scenes.h"
#include "loop/summary.h"
#include "palpate/integrate/integrators.h"
#include "palpate/linear/solvers.h"
#include "palpate/loop/run.h"
#include "palpate/loop/world.h"
#include "proxy/pruner.h"
#include "summary_rows.h"

using namespace palpate;
using block_model::block;
using block_model::ModelOnDisk;
using scene_checks::refusal;

namespace {

// height of the upper block's centre [m]: its lowest corner is 0.2 mm above the lower block
constexpr double kFall = 0.02876;

/// A block on the ground, and a smaller, slightly tilted one that falls on it from a fifth of a millimetre.
struct Blocks {
  LayeredModel lower = block({Quat::Identity(), Vec3(0, 0, 0.01)}, Vec3(0.06, 0.06, 0.02), {4, 4, 2}),
               upper = block({quaternion_of(Vec3(0.05, 0.03, 0.5)), Vec3(0.003, -0.002, kFall)},
                             Vec3(0.03, 0.03, 0.015), {4, 4, 2});
  ModelOnDisk first{lower, "lower.h5"}, second{upper, "upper.h5"},
      both{contact_tests::together(lower, upper), "both.h5"};

  static SoftBodySpec body(const std::string& name, const ModelOnDisk& file) {
    SoftBodySpec out;
    out.name = name;
    out.mesh.file = file.path;
    out.skin = out.proxies = true;
    out.youngs_modulus_pa = 2e4;
    out.stiffness_damping_s = 2e-3;
    AttachmentSpec floor;
    floor.box_min_m = Vec3(-1, -1, -1e-6);
    floor.box_max_m = Vec3(1, 1, 1e-6);
    out.attachments.push_back(floor);
    return out;
  }
  scene::Description scene(bool as_one, const std::string& method = "distance") const {
    scene::Description d;
    d.name = "blocks";
    d.duration_s = 0.03;
    if (as_one)
      d.bodies = {body("both", both)};
    else
      d.bodies = {body("lower", first), body("upper", second)};
    if (!as_one) d.bodies[1].attachments.clear();
    d.gravity_m_s2 = Vec3(0, 0, -9.81);
    ContactSpec contact;
    contact.first = d.bodies.front().name;
    contact.second = d.bodies.back().name;
    contact.method = method;
    if (method == "distance") {
      contact.quadrature_error = 1.0;  // each vertex is a point, for one body as for two
    }
    contact.stiffness_pa_m = 1e7;
    contact.damping_pa_s_m = 1e3;
    contact.friction = 0.3;
    contact.friction_regularisation_m_s = 1e-3;  // the default depends on the size of the body
    contact.candidate_gap_m = 1e-3;
    d.contacts.push_back(contact);
    d.integrator.name = "linearly-implicit-euler";
    d.integrator.step_s = 0.002;
    d.integrator.linear_solver = "umfpack";
    d.exchange.exchange_period_s = d.exchange.contact_refresh_s = 0.004;
    return d;
  }
};

/// The bar, U-shaped at rest, whose arms are rotated towards each other by their bones until the tips
/// collide.
struct Fork {
  ModelOnDisk file{bent_bar::model(24, M_PI), "fork.h5"};

  scene::Description scene(const std::string& integrator, bool touching = true,
                           const std::string& method = "distance") const {
    scene::Description d;
    d.name = "fork";
    d.duration_s = 0.1;
    SoftBodySpec body;
    body.name = "fork";
    body.mesh.file = file.path;
    body.skin = body.proxies = true;
    body.youngs_modulus_pa = 2e4;
    body.stiffness_damping_s = 5e-3;
    body.skeleton.emplace();
    for (const auto& [bone, angle] : {std::pair("left", 0.36), std::pair("right", -0.36)}) {
      JointSpec joint;
      joint.bone = bone;
      joint.keyframes.resize(2);
      joint.keyframes[1].time_s = 0.08;
      joint.keyframes[1].rotation_vector_rad = Vec3(0, angle, 0);
      body.skeleton->joints.push_back(joint);
    }
    d.bodies.push_back(body);
    ContactSpec contact;
    contact.first = contact.second = "fork";
    contact.method = method;
    contact.stiffness_pa_m = 1e6;
    contact.onset_width_m = 5e-3;
    if (touching) d.contacts.push_back(contact);
    d.bodies[0].proxies = false;
    d.integrator.name = integrator;
    d.integrator.step_s = 1e-3;
    d.integrator.rtol = 1e-5;
    d.exchange.exchange_period_s = d.exchange.contact_refresh_s = 0.01;
    return d;
  }
};

}  // namespace

TEST(OwnContactScene, OnlyASceneThatNamesItHasIt) {
  const Fork fork;
  counters::reset();
  loop::assemble(fork.scene("linearly-implicit-euler", false));
  EXPECT_EQ(counters::counter("contact.self_contact_filter"), 0);
  const Blocks blocks;
  loop::assemble(blocks.scene(false));
  EXPECT_EQ(counters::counter("contact.self_contact_filter"), 0) << "two bodies";
  loop::assemble(fork.scene("linearly-implicit-euler"));
  EXPECT_EQ(counters::counter("contact.self_contact_filter"), 1);
}

TEST(OwnContactScene, RefusesWhatCannotMeetItself) {
  const Fork fork;
  scene::Description d = fork.scene("linearly-implicit-euler");
  for (const char* method : {"analytic", "image"}) {
    d.contacts[0].method = method;
    EXPECT_NE(
        refusal(d).find("self-contact needs method = \"distance\" (nearest points); use method = \"auto\""),
        std::string::npos)
        << refusal(d);
  }
}

namespace {

/// Displacement of each node, body by body in the order of its file; `pressing`: number of contact samples
/// with pressure at the end.
VecX end_of(const scene::Description& d, int* pressing = nullptr) {
  const auto world = loop::assemble(d);
  const VecX start = world->state.q();
  const auto result = loop::run(*world, {});
  EXPECT_TRUE(result.status.ok()) << d.integrator.name << ", " << d.integrator.linear_solver << ": "
                                  << result.status.message;
  if (pressing && world->contact)
    for (const contact::ContactSample& s : world->contact->samples()) *pressing += s.gap < 0.0;
  VecX gone(start.size());
  Eigen::Index first = 0;
  for (const loop::Body& body : world->bodies) {
    const Eigen::Index begin = world->state.layout().find(body.block_id)->q_offset, n = body.placed.cols();
    gone.segment(first, 3 * n).reshaped(3, n)(Eigen::all, body.file_node) =
        (world->state.q() - start).segment(begin, 3 * n).reshaped(3, n);
    first += 3 * n;
  }
  return gone;
}

}  // namespace

// With equal nodes, masses, forces and contact, a body that falls on another body or on a part of itself
// moves equally, to rounding: a vertex has the same foot. (Friction deflections rotate with the foot of a
// body's own points, and with the second of two bodies.)
TEST(OwnContactScene, TwoBlocksOfOneBodyMeetAsTwoBodies) {
  const Blocks blocks;
  scene::Description together = blocks.scene(true), apart = blocks.scene(false), without = blocks.scene(true);
  without.contacts.clear();
  for (scene::Description* d : {&together, &apart, &without}) {
    for (SoftBodySpec& body : d->bodies) body.proxies = false;
    for (ContactSpec& contact : d->contacts) contact.friction_anchors = false;
  }
  int pressing = 0;
  const VecX two = end_of(apart), one = end_of(together, &pressing);
  ASSERT_EQ(two.size(), one.size());
  EXPECT_GT(pressing, 30);
  EXPECT_LT((two - one).norm(), 1e-6 * two.norm());
  EXPECT_GT((end_of(without) - one).norm(), 0.02 * one.norm()) << "contact is what holds it";
}

// A body without skin or proxies is in self-contact by default: by its boundary, with nearest points.
TEST(OwnContactScene, ABoundaryTouchesItself) {
  const Fork fork;
  scene::Description d = fork.scene("linearly-implicit-euler", true, "auto");
  d.bodies[0].skin = d.bodies[0].proxies = false;
  counters::reset();
  int pressing = 0;
  const VecX with = end_of(d, &pressing);
  EXPECT_GT(pressing, 10);
  EXPECT_EQ(counters::counter("contact.distance_source"), 1);
  EXPECT_EQ(counters::counter("proxy.pruner"), 0);
  d.contacts.clear();
  EXPECT_GT((with - end_of(d)).cwiseAbs().maxCoeff(), 5e-3) << "the tips are held apart";
}

// Every linear solver supports blocks between distant nodes of one body, or reports why not.
TEST(OwnContactScene, EveryLinearSolverTakesIt) {
  const Fork fork;
  scene::Description d = fork.scene("linearly-implicit-euler");
  d.integrator.linear_solver = "umfpack";
  const VecX exact = end_of(d);
  int solvers = 0;
  for (const auto& entry : linear::linear_solver_registry()) {
    d.integrator.linear_solver = entry.name;
    EXPECT_LT((end_of(d) - exact).norm(), 2e-4 * exact.norm()) << entry.name;
    ++solvers;
  }
  EXPECT_GE(solvers, 5);
}

// Feet cross edges, so that an error-controlled integrator takes small steps: the reference uses a tenth of
// the tolerance.
TEST(OwnContactScene, ArmsCloseAlikeByNearestPoints) {
  const Fork fork;
  scene::Description fine = fork.scene("cvode-bdf");
  fine.integrator.rtol = 1e-6;
  int pressing = 0;
  const VecX reference = end_of(fine, &pressing), free = end_of(fork.scene("cvode-bdf", false));
  EXPECT_GT(pressing, 50) << "the arms have met";
  EXPECT_GT((free - reference).cwiseAbs().maxCoeff(), 4e-3) << "and are dented";
  EXPECT_LT((end_of(fork.scene("cvode-bdf")) - reference).norm(), 1e-3 * reference.norm());
  scene::Description d = fork.scene("linearly-implicit-euler");
  for (const double step : {1e-3, 2.5e-4}) {
    d.integrator.step_s = step;
    EXPECT_LT((end_of(d) - reference).norm(),
              0.03 * step / 1e-3 * reference.norm() + 5e-3 * reference.norm());
  }
}

// An overlap close to the depth beyond which contact ends is reported as too deep.
TEST(OwnContactScene, DeepOverlapsAreTold) {
  const Fork fork;
  for (const bool is_deep : {false, true}) {
    scene::Description d = fork.scene("linearly-implicit-euler");
    if (is_deep)
      for (JointSpec& joint : d.bodies[0].skeleton->joints) joint.keyframes[1].rotation_vector_rad *= 1.5;
    const auto world = loop::assemble(d);
    EXPECT_FALSE(loop::penetration_reports(*world)[0].too_deep());
    EXPECT_TRUE(loop::run(*world, {}).status.ok());
    const loop::PenetrationReport penetration = loop::penetration_reports(*world)[0];
    const TriMesh& skin = world->bodies[0].skin->rest;
    EXPECT_TRUE(penetration.of_itself);
    EXPECT_NEAR(penetration.half_width_m, 0.75 * 0.25 * contact::lengths_of(skin).radius, 1e-12);
    EXPECT_GT(penetration.deepest_m, 1e-3);
    EXPECT_EQ(penetration.too_deep(), is_deep) << penetration.deepest_m;
  }
}

#ifdef PALPATE_HAS_GL
// The summary of contact in images states which part of each skin the proxies passed on.
TEST(ImageScene, TheSummarySpeaksOfBothSkins) {
  const Blocks blocks;
  const scene::Description d = blocks.scene(false, "image");
  const auto world = loop::assemble(d);
  const auto result = loop::run(*world, {});
  EXPECT_TRUE(result.status.ok());
  store::Summary summary = loop::summarise(*world, result, 0.0);
  const store::SummaryFields& row = summary.list("contacts").at(0);
  EXPECT_EQ(std::get<std::string>(*summary_rows::find(row, "method")), "image");
  const auto of_two = *world->contact->pairs()[0].pruning;
  const auto* triangles = summary_rows::find(row, "rasterised_triangles");
  const auto* shares = summary_rows::find(row, "mean_rasterised_share");
  ASSERT_TRUE(triangles && shares);
  EXPECT_EQ(std::get<std::vector<long long>>(*triangles),
            (std::vector<long long>{of_two.faces_a, of_two.faces_b}));
  for (const auto& [side, rasterised, skin] :
       {std::tuple(0u, of_two.faces_a, blocks.lower.skin.faces.cols()),
        std::tuple(1u, of_two.faces_b, blocks.upper.skin.faces.cols())}) {
    EXPECT_GT(rasterised, 0);
    EXPECT_DOUBLE_EQ(std::get<std::vector<double>>(*shares)[side],
                     static_cast<double>(rasterised) / static_cast<double>(of_two.queries * skin));
  }
  EXPECT_EQ(summary_rows::count(row, "normals_kept"), world->contact->pairs()[0].normals_kept);
}
#endif
