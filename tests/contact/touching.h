#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "contact/sample_math.h"
#include "together.h"
#include "two_balls.h"

namespace contact_tests {

/// A pair of any kind in contact, with its frames and source; the law is added by the test.
struct Touching {
  dynamics::State state;
  std::vector<std::shared_ptr<contact::MovingFrame>> frames;
  std::unique_ptr<contact::SampleSource> source;
};
struct TouchingKind {
  std::string name;
  std::function<Touching()> make;
  bool pruned = true;        ///< by proxies
  bool of_vertices = false;  ///< samples are points of a surface
  bool of_ball = false;      ///< one side is a ball by its own points, which do not rotate with it
  bool image = false;        ///< in image space: a query uses OpenGL
};

namespace touching {

/// The tool's pose: oblique, away from the origin.
inline Pose tool_pose() { return {quaternion_of(Vec3(0.3, -0.2, 0.5)), Vec3(0.15, -0.1, 0.2)}; }

/// Adds a frame for the other side: fixed, or a moving body of the State.
inline std::shared_ptr<contact::MovingFrame> add_frame(Touching& out, const Pose& pose, bool in_state) {
  const Twist twist{Vec3(0.3, -0.4, 0.2), Vec3(0.1, -0.2, 0.3)};
  out.frames.push_back(in_state ? contact::block_frame(add_rigid_body(out.state, pose, twist))
                                : contact::fixed_frame(pose));
  return out.frames.back();
}

/// The soft side: nodes of a sphere, or the skin of a bent ball with extrapolated weights; its lowest point.
struct Soft {
  dynamics::State state;
  contact::NodeSurface surface;
  std::shared_ptr<proxy::ProxySet> proxies;
  Vec3 bottom;
  Points rest;  ///< the surface's vertices at rest
  TetMesh body{};
};
inline Soft soft_nodes() {
  SurfaceWorld world(sphere(Vec3::Zero(), 1.0, 16));
  for (Eigen::Index i = 0; i < world.state.u().size(); ++i)
    world.state.u()[i] = 0.3 * std::sin(1.0 + 2.0 * static_cast<double>(i));
  return {world.state, world.surface, nullptr, Vec3(0, 0, -1), sphere(Vec3::Zero(), 1.0, 16).vertices};
}
inline Soft soft_skin() {
  SkinWorld world;
  world.state.u() *= 0.3;
  Eigen::Index lowest = 0;
  world.vertices.row(2).minCoeff(&lowest);
  return {world.state,
          world.surface,
          proxies_of(world.ball, world.skin, world.surface.embedding, 2),
          world.vertices.col(lowest),
          world.skin.vertices,
          world.ball};
}

/// An analytic shape below the soft body, overlapping by `depth`, in a frame at tool_pose(); sampled at
/// vertices or at material points.
inline Touching on_shape(const std::string& shape, bool skin, bool in_state, bool points = false) {
  constexpr double kDepth = 0.15;
  const Soft soft = skin ? soft_skin() : soft_nodes();
  Touching out;
  out.state = soft.state;
  const Pose pose = tool_pose();
  const auto frame = add_frame(out, pose, in_state);
  const Vec3 top = pose.inverse() * Vec3(soft.bottom + Vec3(0, 0, kDepth)),
             up = pose.rotation.conjugate() * Vec3(0.1, -0.05, 1.0).normalized();
  // the shape's axes, z along up; its top face or its round side touches
  const Pose upright{Quat::FromTwoVectors(Vec3::UnitZ(), up), top - 0.6 * up},
      lying{Quat::FromTwoVectors(Vec3::UnitX(), up), top - 0.6 * up};
  contact::ContactSide surface = soft.surface;
  if (points) surface = contact::material_points(soft.surface, soft.rest, soft.body, 0.2);
  if (shape == "plane") out.source = contact::make_plane_source(surface, 0, frame, top, up, 0.05);
  if (shape == "sphere")
    out.source = contact::make_sphere_source(surface, 0, frame, top - 0.6 * up, 0.6, 0.05);
  if (shape == "box")
    out.source = contact::make_box_source(surface, 0, frame, upright, Vec3(0.8, 1.0, 1.2), 0.05);
  if (shape == "cylinder")
    out.source = contact::make_cylinder_source(surface, 0, frame, lying, 0.6, 1.5, 0.05);
  return out;
}

/// A rigid ball in the axes of tool_pose(), pressed into the body from below.
inline TriMesh tool_ball(const Soft& soft) {
  TriMesh tool = sphere(Vec3::Zero(), 0.6, 16);
  for (auto x : tool.vertices.colwise())
    x = tool_pose().inverse() * Vec3(x + soft.bottom - Vec3(0.05, 0.02, 0.45));
  return tool;
}

/// The rigid ball in image space.
inline Touching on_tool(bool pruned, bool in_state) {
  const Soft soft = soft_skin();
  Touching out;
  out.state = soft.state;
  const auto frame = add_frame(out, tool_pose(), in_state);
  const TriMesh tool = tool_ball(soft);
  const contact::ImageOptions options = image_options(24, 0.05);
  out.source = pruned ? contact::make_image_source(soft.surface, soft.proxies, tool, proxies_of(tool), 0,
                                                   frame, options)
                      : contact::make_image_source(soft.surface, tool, 0, frame, options);
  return out;
}

/// The rigid ball by nearest points.
inline Touching near_tool(bool in_state) {
  const Soft soft = soft_skin();
  Touching out;
  out.state = soft.state;
  const auto frame = add_frame(out, tool_pose(), in_state);
  const TriMesh tool = tool_ball(soft);
  out.source = contact::make_distance_source(soft.surface, mesh::sphere(1.0, 12).vertices,
                                             contact::FrameSurface{tool, 0, frame}, {.candidate_gap = 0.05});
  return out;
}

/// Points of a skin on a sphere, and the sphere's points, each with half weight.
inline Touching half_and_half(bool in_state) {
  const Soft soft = soft_skin();
  Touching out;
  out.state = soft.state;
  const Vec3 at = soft.bottom - Vec3(0.05, 0.02, 0.45);
  const auto frame = add_frame(out, Pose{tool_pose().rotation, at}, in_state);
  constexpr double kRadius = 0.6;
  const contact::ShapePoints own{{contact::sphere_surface(kRadius, 0.15), 0, frame},
                                 0.15,
                                 [=](const Vec3& x) { return Vec3(kRadius * x.normalized()); },
                                 Vec3::Zero()};
  out.source = contact::make_half_and_half(
      contact::make_sphere_source(contact::material_points(soft.surface, soft.rest, soft.body, 0.2), 0, frame,
                                  Vec3::Zero(), kRadius, 0.05),
      contact::make_distance_source(soft.surface, soft.rest, own, {.candidate_gap = 0.05}));
  return out;
}

inline Touching two_near() {
  TwoBalls balls;
  Touching out;
  out.source = contact::make_distance_source(balls.a.surface, balls.a.model.skin.vertices, balls.b.surface,
                                             balls.b.model.skin.vertices, {.candidate_gap = 0.02});
  out.state = balls.state;
  return out;
}

inline Touching two_soft(bool pruned) {
  TwoBalls balls;
  balls.pixels = 24;
  Touching out;
  out.source = balls.source(pruned);
  out.state = balls.state;
  return out;
}

/// Two balls that form one body, in self-contact.
inline Touching itself() {
  const TwoBalls balls;
  const LayeredModel both = [&] {
    LayeredModel a = balls.a.model, b = balls.b.model;
    for (LayeredModel* model : {&a, &b}) model->embedding = mesh::embed(model->tets, model->skin.vertices);
    return together(a, b);
  }();
  // overlaps at rest do not count as contact: at rest the balls are apart
  Points rest = both.tets.nodes, rest_skin = both.skin.vertices;
  rest.rightCols(balls.b.model.tets.nodes.cols()).row(2).array() -= 1.0;
  rest_skin.rightCols(balls.b.model.skin.vertices.cols()).row(2).array() -= 1.0;
  Touching out;
  contact::NodeSurface surface;
  dynamics::BlockSpec nodes;
  nodes.name = "both";
  nodes.q_size = nodes.u_size = static_cast<int>(both.tets.nodes.size());
  surface.block_id = out.state.insert(nodes, Eigen::Map<const VecX>(both.tets.nodes.data(), nodes.q_size),
                                      VecX(balls.state.u()));
  surface.faces = both.skin.faces;
  surface.embedding = both.embedding;
  surface.tets = both.tets.tets;
  out.source = contact::make_own_distance_source(surface, rest_skin, rest, {.candidate_gap = 0.02});
  return out;
}

}  // namespace touching

/// Every kind of pair: nodes and skins, with frames at rest and frames in the State.
inline std::vector<TouchingKind> touching_kinds() {
  std::vector<TouchingKind> out;
  for (const char* shape : {"plane", "sphere", "box", "cylinder"}) {
    const std::string name = shape;
    out.push_back(
        {"nodes on a " + name, [=] { return touching::on_shape(name, false, false); }, false, true});
    out.push_back(
        {"a skin on a moving " + name, [=] { return touching::on_shape(name, true, true); }, false, true});
  }
  out.push_back({"points of nodes on a cylinder",
                 [] { return touching::on_shape("cylinder", false, false, true); }, false});
  out.push_back({"points of a skin on a moving sphere",
                 [] { return touching::on_shape("sphere", true, true, true); }, false});
  if (contact::gpu_available()) {
    out.push_back(
        {"a skin on a tool, image", [] { return touching::on_tool(true, true); }, true, true, false, true});
    out.push_back({"a skin on a tool, image, unpruned", [] { return touching::on_tool(false, true); }, false,
                   true, false, true});
    out.push_back({"two skins, image", [] { return touching::two_soft(true); }, true, true, false, true});
    out.push_back(
        {"two skins, image, unpruned", [] { return touching::two_soft(false); }, false, true, false, true});
  }
  out.push_back({"a skin on a tool, nearest points", [] { return touching::near_tool(true); }, false});
  out.push_back({"a skin and a moving sphere, points of both", [] { return touching::half_and_half(true); },
                 false, false, true});
  out.push_back({"two skins, nearest points", [] { return touching::two_near(); }, false});
  out.push_back({"a body against itself", [] { return touching::itself(); }, false});
  return out;
}

inline std::vector<contact::FrameState> frame_states(const Touching& at, const dynamics::StateView& state) {
  std::vector<contact::FrameState> out;
  for (const auto& frame : at.frames) {
    const Pose pose = frame->pose(state);
    out.push_back({pose, pose.rotation.toRotationMatrix(), frame->twist(state), frame->u_offset(state)});
  }
  return out;
}

}  // namespace contact_tests
