#include "contact/contact_force_impl.h"
#include "palpate/core/error.h"

namespace palpate::contact {
namespace {

void reset(FrameLinearisation& out, Eigen::Index nodal) {
  out.wrench = {};
  out.K.setZero();
  out.B.setZero();
  out.geometric.setZero();
  for (MatX* m : {&out.K_body, &out.B_body}) m->setZero(nodal, 6);
  for (MatX* m : {&out.K_frame, &out.B_frame}) m->setZero(6, nodal);
  out.active = 0;
}

/// Adds the coupling of the other side's nodes with the frame: see the derivation in tangent.cpp, with the
/// frame as q (columns) or p (rows).
void add_node_coupling(const Side& frame, const Side& nodes, const SampleForce& s, FrameLinearisation& out) {
  const double sign = frame.sign * nodes.sign;
  Mat36 columns_k = sign * s.K * frame.Z;
  columns_k.leftCols<3>().noalias() += sign * s.D * frame.V;
  const Mat36 columns_b = sign * s.D * frame.Z;
  const Mat63 rows_k = sign * frame.Z.transpose() * s.K, rows_b = sign * frame.Z.transpose() * s.D;
  for (int i = 0; i < nodes.point.count; ++i) {
    const double w = nodes.point.weight[static_cast<std::size_t>(i)];
    const int at = 3 * nodes.point.node[static_cast<std::size_t>(i)];
    out.K_body.middleRows<3>(at) += w * columns_k;
    out.B_body.middleRows<3>(at) += w * columns_b;
    out.K_frame.middleCols<3>(at) += w * rows_k;
    out.B_frame.middleCols<3>(at) += w * rows_b;
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

Wrench ContactForce::frame_wrench(const dynamics::StateView& state, int frame) const {
  Impl& m = *impl_;
  m.place_frames(state);
  Wrench sum = m.bonds.wrench(state, m.frame_states, frame);
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
  reset(out, partners == Partners::kFrames ? 0 : state.layout->nodal_size);
  m.place_frames(state);
  if (partners != Partners::kFrames) m.bonds.linearise(state, m.frame_states, frame, out);
  const auto add = [&](const ContactSample& s, const SampleMotion& motion, const PressureLaw& law) {
    if (s.a.frame != frame && s.b.frame != frame) return;
    PALPATE_CHECK(s.a.frame != s.b.frame, "both sides of a contact sample have frame {}", frame);
    const bool two_frames = s.a.frame >= 0 && s.b.frame >= 0;
    if (partners == (two_frames ? Partners::kNodes : Partners::kFrames)) return;
    const SampleForce force = m.tangent_of(s, motion, law, false);
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

}  // namespace palpate::contact
