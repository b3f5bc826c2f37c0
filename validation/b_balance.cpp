#include <algorithm>
#include <cmath>
#include <random>

#include "b_bodies.h"
#include "cases.h"
#include "images.h"
#include "palpate/core/error.h"
#include "palpate/mesh/embedding.h"
#include "palpate/mesh/generators.h"

// Problem: forces and moments of contact between two bodies must balance. Bodies are coarse balls and
// boxes of tetrahedra, bent, under fine skins, in random poses; the other body is one of these too, or rigid.
//
// Exact answer (action equals reaction): a sample applies equal and opposite forces to its two points, which
// lie on one line along the normal, so that the sum of all forces is zero, and so is the sum of their moments
// about any origin. This carries over to the nodes only if a point's force is distributed by the weights that
// place the point, also where the skin lies outside its tetrahedron (negative weights): moving the force to
// the surface of the tetrahedron would leave the moment offset x force. Friction acts across the line: its
// forces sum to zero, and its moment about any origin is at most depth x friction per sample, because the two
// points are the depth apart.
//
// Measured: the sums over both bodies, relative to the force on one body (and its size). Limit 1e-12,
// rounding; for the moment of friction 1, its bound depth x friction.

namespace palpate::validation {
namespace {

constexpr int kPoses = 8;
constexpr double kSize = 1.0;

struct Random {
  std::mt19937 generator;
  double operator()() { return std::uniform_real_distribution<double>(-1.0, 1.0)(generator); }
  Vec3 vector() {
    const double x = (*this)(), y = (*this)(), z = (*this)();
    return {x, y, z};
  }
};

struct Body {
  TriMesh skin;
  Points rest;  ///< Vertices of the skin at rest [m].
  contact::NodeSurface surface;
};

/// Adds a ball (even `kind`) or a box under its skin, at a random pose about `centre`, bent, with velocities.
Body add_body(dynamics::State& state, int kind, const Vec3& centre, Random& random) {
  Body out;
  TetMesh tets = kind % 2 == 0 ? mesh::ball(kSize, 0.5) : mesh::box(Vec3(1.5, 1.6, 1.7), {2, 2, 2});
  out.skin =
      kind % 2 == 0 ? mesh::sphere(1.03 * kSize, 20) : mesh::box_surface(Vec3(1.6, 1.7, 1.8), {15, 15, 15});
  out.rest = out.skin.vertices;
  out.surface.faces = out.skin.faces;
  out.surface.embedding = mesh::embed(tets, out.skin.vertices);
  out.surface.tets = tets.tets;
  const Mat3 turn = quaternion_of(2.0 * random.vector()).toRotationMatrix();
  const Vec3 bend = 0.1 * random.vector();
  for (auto x : tets.nodes.colwise()) x = (centre + turn * Vec3(x + bend * x.z() * x.x())).eval();
  mesh::evaluate(out.surface.embedding, tets.tets, tets.nodes, out.skin.vertices);
  dynamics::BlockSpec nodes;
  nodes.name = "body";
  nodes.q_size = nodes.u_size = static_cast<int>(tets.nodes.size());
  VecX speeds(nodes.u_size);
  for (double& v : speeds) v = random();
  out.surface.block_id = state.insert(nodes, tets.nodes.reshaped(), speeds);
  return out;
}

/// Sums over both bodies, relative to the force on one body (and to its size).
struct Balance {
  double force = 0.0, moment = 0.0;  ///< Without friction.
  double friction_force = 0.0;       ///< With friction.
  double friction_moment = 0.0;      ///< Relative to the bound, depth x friction.
  int samples = 0;
};

/// Applies a fault to a source. "no-rest-offset": negative weights are cut off; "force-on-one-side": a
/// tenth of the force is lost on one side; "points-apart": the point of the other side is off the sample's
/// line.
std::unique_ptr<contact::SampleSource> with_fault(std::unique_ptr<contact::SampleSource> source,
                                                  const std::string& fault) {
  if (fault == "force-on-one-side")
    return spoiled(std::move(source), [](auto& samples) {
      for (auto& s : samples)
        for (double& w : s.a.weight) w *= 0.9;
    });
  if (fault == "points-apart")
    return spoiled(std::move(source), [](auto& samples) {
      for (auto& s : samples) {
        if (s.b.frame >= 0) s.b.offset += 0.5 * kSize * s.normal.unitOrthogonal();
        std::rotate(s.b.weight.begin(), s.b.weight.begin() + 1, s.b.weight.begin() + std::max(1, s.b.count));
      }
    });
  if (fault != "no-rest-offset") return source;
  return spoiled(std::move(source), [](auto& samples) {
    for (auto& s : samples)
      for (contact::SurfacePoint* p : {&s.a, &s.b}) {
        double sum = 0.0;
        for (double& w : p->weight) sum += w = std::max(0.0, w);
        for (double& w : p->weight) w /= p->frame < 0 ? sum : 1.0;
      }
  });
}

Balance balance_of(bool image, bool soft, int pose, const std::string& fault) {
  Random random{std::mt19937(static_cast<unsigned>(100 + pose))};
  dynamics::State state;
  const Vec3 axis = (Vec3::UnitZ() + 0.3 * random.vector()).normalized();
  const Body a = add_body(state, pose, 0.85 * axis, random);
  Body b;
  TriMesh rigid;
  if (soft) {
    b = add_body(state, pose / 2, -0.75 * axis, random);
  } else {
    rigid = mesh::sphere(kSize, 20);
  }
  const Pose rigid_pose{quaternion_of(random.vector()), -0.75 * axis};
  const contact::ImageOptions by_image{.pixels = 96, .candidate_gap = 1e-3};
  const contact::DistanceOptions by_points{.candidate_gap = 1e-3};
  Balance out;
  for (const double friction : {0.0, 0.5}) {
    const auto frame = contact::fixed_frame(rigid_pose);
    contact::ContactForce term;
    term.add_frame(frame);
    ContactSpec law;
    law.stiffness_pa_m = 1e5;
    law.damping_pa_s_m = 1e2;
    law.friction = friction;
    std::unique_ptr<contact::SampleSource> source;
    if (image)
      source = soft ? contact::make_image_source(a.surface, b.surface, by_image)
                    : contact::make_image_source(a.surface, rigid, 0, frame, by_image);
    else
      source = soft ? contact::make_distance_source(a.surface, a.rest, b.surface, b.rest, by_points)
                    : contact::make_distance_source(a.surface, a.rest, contact::FrameSurface{rigid, 0, frame},
                                                    by_points);
    term.add_pair(with_fault(std::move(source), fault), law);
    term.refresh(state.view());
    VecX f = VecX::Zero(state.layout().u_size);
    term.add_force(state.view(), f);
    const int of_a = static_cast<int>(state.layout().find(a.surface.block_id)->u_size / 3);
    Vec3 on_a = Vec3::Zero(), sum = Vec3::Zero(), moment = Vec3::Zero();
    for (int i = 0; i < state.layout().node_count(); ++i) {
      const Vec3 force = f.segment<3>(3 * i);
      if (i < of_a) on_a += force;
      sum += force;
      moment += state.view().position(i).cross(force);
    }
    if (!soft) {
      const Wrench wrench = term.frame_wrench(state.view(), 0);
      sum += wrench.force;
      moment += wrench.moment + rigid_pose.translation.cross(wrench.force);
    }
    double deepest = 0.0;
    for (const auto& s : term.samples()) deepest = std::max(deepest, -s.gap);
    if (friction == 0.0) {
      out.samples = static_cast<int>(term.samples().size());
      out.force = sum.norm() / on_a.norm();
      out.moment = moment.norm() / (on_a.norm() * kSize);
    } else {
      out.friction_force = sum.norm() / on_a.norm();
      out.friction_moment = moment.norm() / (deepest * friction * on_a.norm());
    }
  }
  return out;
}

std::vector<Measurement> run(const std::string& fault) {
  std::vector<Measurement> out;
  for (const bool image : {false, true}) {
    if (image && !images_work()) break;
    for (const bool soft : {false, true}) {
      Balance worst;
      worst.samples = 1 << 30;
      for (int pose = 0; pose < kPoses; ++pose) {
        const Balance one = balance_of(image, soft, pose, fault);
        worst.force = std::max(worst.force, one.force);
        worst.moment = std::max(worst.moment, one.moment);
        worst.friction_force = std::max(worst.friction_force, one.friction_force);
        worst.friction_moment = std::max(worst.friction_moment, one.friction_moment);
        worst.samples = std::min(worst.samples, one.samples);
      }
      const std::string name =
          std::string(image ? "image" : "nearest points") + (soft ? ", soft on soft: " : ", soft on rigid: ");
      const auto add = [&](const std::string& quantity, double value, double bar) {
        out.push_back({.quantity = name + quantity,
                       .computed = value,
                       .error = worst.samples > 50 ? value : std::nan(""),
                       .bar = bar,
                       .note = fmt::format("worst of {} poses, {} samples and more", kPoses, worst.samples)});
      };
      add("sum of normal forces, over the force on one", worst.force, 1e-12);
      add("sum of their moments, over force x body size", worst.moment, 1e-12);
      add("sum of forces with friction, over the force on one", worst.friction_force, 1e-12);
      add("their moment, over depth x friction", worst.friction_moment, 1.0);
    }
  }
  say_what_is_skipped(out);
  return out;
}

}  // namespace

ValidationCase balance() {
  return {.name = "balance",
          .section = "B",
          .summary = "forces and moments of contact on both bodies sum to zero, for random poses and skins",
          .why =
              "an unbalanced contact accelerates the bodies in contact without external force (action and "
              "reaction, points on one line)",
          .quick = true,
          .run = run,
          .faults = {{"no-rest-offset", "sum of their moments"},
                     {"force-on-one-side", "sum of normal forces"},
                     {"force-on-one-side", "sum of forces with friction"},
                     {"points-apart", "their moment, over depth x friction"}}};
}

}  // namespace palpate::validation
