#include "contact/contact_force_impl.h"
#include "palpate/core/error.h"

namespace palpate::contact {
namespace {

/// The other side's nodes against the frame: see the derivation in tangent.cpp, with q (columns) or p (rows)
/// the frame.
void add_node_coupling(const Side& frame, const Side& nodes, const SampleForce& s, FrameLinearisation& out) {
  const double sign = frame.sign * nodes.sign;
  Mat36 columns_k = sign * s.K * frame.Z;
  columns_k.leftCols<3>().noalias() += sign * s.D * frame.V;
  const Mat36 columns_b = sign * s.D * frame.Z;
  const Mat63 rows_k = sign * frame.Z.transpose() * s.K, rows_b = sign * frame.Z.transpose() * s.D;
  for (int i = 0; i < nodes.point.count; ++i) {
    const double w = nodes.point.weight[static_cast<std::size_t>(i)];
    NodeCoupling& to = out.of_node(nodes.point.node[static_cast<std::size_t>(i)]);
    to.K_body += w * columns_k;
    to.B_body += w * columns_b;
    to.K_frame += w * rows_k;
    to.B_frame += w * rows_b;
  }
}

void add_frame_block(const Side& frame, const SampleForce& s, FrameLinearisation& out) {
  Mat36 columns = s.K * frame.Z;
  columns.leftCols<3>().noalias() += s.D * frame.V;
  out.K.noalias() += frame.Z.transpose() * columns;
  out.K.topLeftCorner<3, 3>() -= frame.sign * frame.G;
  out.geometric += frame.sign * frame.G;
  out.B.noalias() += frame.Z.transpose() * (s.D * frame.Z);
}

}  // namespace

void FrameLinearisation::clear() {
  wrench = {};
  K.setZero();
  B.setZero();
  geometric.setZero();
  for (const NodeCoupling& one : nodes) place_[static_cast<std::size_t>(one.node)] = -1;
  nodes.clear();
  active = 0;
}

NodeCoupling& FrameLinearisation::of_node(int node) {
  const auto at = static_cast<std::size_t>(node);
  if (at >= place_.size()) place_.resize(at + 1, -1);
  if (place_[at] < 0) {
    place_[at] = static_cast<int>(nodes.size());
    nodes.push_back({node});
  }
  return nodes[static_cast<std::size_t>(place_[at])];
}

Vec6 FrameLinearisation::wrench_of_nodes(const VecX& x, const VecX& v) const {
  Vec6 out = Vec6::Zero();
  for (const NodeCoupling& one : nodes)
    out -= one.K_frame * x.segment<3>(3 * one.node) + one.B_frame * v.segment<3>(3 * one.node);
  return out;
}

Wrench ContactForce::frame_wrench(const dynamics::StateView& state, int frame) const {
  Impl& m = *impl_;
  m.place_frames(state);
  Wrench sum = m.groups.wrench(state, m.frame_states, frame);
  m.visit_active(state, Impl::Which::kEvery,
                 [&](const ContactSample& s, const SampleMotion& motion, const PressureLaw& law) {
                   if (s.a.frame != frame && s.b.frame != frame) return;
                   const Vec3 force = sample_force(s, motion, law);
                   if (s.a.frame == frame) sum += {motion.a.arm.cross(force), force};
                   if (s.b.frame == frame) sum += {-motion.b.arm.cross(force), -force};
                 });
  return sum;
}

void ContactForce::linearise(const dynamics::StateView& state, int frame, FrameLinearisation& out,
                             Partners partners) const {
  Impl& m = *impl_;
  PALPATE_CHECK(frame >= 0 && frame < static_cast<int>(m.frames.size()), "frame {} of {}", frame,
                m.frames.size());
  out.clear();
  m.place_frames(state);
  if (partners != Partners::kFrames) m.groups.linearise(state, m.frame_states, frame, out);
  const auto add = [&](const ContactSample& s, const SampleMotion& motion, const PressureLaw& law) {
    if (s.a.frame != frame && s.b.frame != frame) return;
    PALPATE_CHECK(s.a.frame != s.b.frame, "a contact sample has frame {} on both sides", frame);
    const bool two_frames = s.a.frame >= 0 && s.b.frame >= 0;
    if (partners == (two_frames ? Partners::kNodes : Partners::kFrames)) return;
    const SampleForce force = sample_force_and_tangent(s, motion, law);
    if (force.force.isZero(0.0)) return;
    const Side a(s.a, motion.a, m.frame_states, 1.0, force.force),
        b(s.b, motion.b, m.frame_states, -1.0, force.force);
    const Side& mine = s.a.frame == frame ? a : b;
    const Side& other = s.a.frame == frame ? b : a;
    out.wrench.force += mine.sign * force.force;
    out.wrench.moment += mine.sign * (s.a.frame == frame ? motion.a : motion.b).arm.cross(force.force);
    add_frame_block(mine, force, out);
    if (other.is_nodes()) add_node_coupling(mine, other, force, out);
    ++out.active;
  };
  m.visit_active(state, Impl::Which::kEvery, add);
}

Mat3 ContactForce::geometric_stiffness(const dynamics::StateView& before, const dynamics::StateView& after,
                                       int frame) const {
  Impl& m = *impl_;
  m.place_frames(after);
  Mat3 sum = m.groups.geometric_stiffness(after, m.frame_states, frame);
  const auto add = [&](const ContactSample& s, const SampleMotion& motion, const PressureLaw& law) {
    if ((s.a.frame != frame && s.b.frame != frame) || (s.a.frame >= 0 && s.b.frame >= 0)) return;
    Vec3 force = s.area * pressure(law, motion.gap, motion.rate).p * s.normal;
    if (law.friction > 0.0) {
      const SampleMotion slip = sample_motion(s, before, m.frame_states);
      force += pressure(law, motion.gap, motion.rate).p * friction_per_pressure(s, slip, law);
    }
    const bool first = s.a.frame == frame;
    const Side mine(first ? s.a : s.b, first ? motion.a : motion.b, m.frame_states, first ? 1.0 : -1.0,
                    force);
    sum += mine.sign * mine.G;
  };
  m.visit_active(after, Impl::Which::kEvery, add);
  return sum;
}

}  // namespace palpate::contact
