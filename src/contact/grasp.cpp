#include "contact/grasp.h"

#include <algorithm>

#include "palpate/core/error.h"

namespace palpate::contact {

// Grasp of the points that press on a frame. Contact continues unchanged, and in addition each sample's
// points are tied by a spring k and a damper d (areas included) in the directions where contact does not act:
// along the surface, and against separation. With the held point x of the body, the point y of the frame that
// it is tied to, u = y - x, and the unit normal n along the force on the frame, rotating with the frame,
//     g = n . u,      E = k/2 (|u|^2 - min(g, 0)^2),
// so that E has no part along n while the points press (contact has it there), and is a spring of zero length
// otherwise. With k equal to the stiffness of contact both together are one linear spring through g = 0, for
// `onset_width_m` = 0.
//
// E does not change when frame and body move rigidly together, so that it is balanced in force and moment.
// Its force, and the damper's, act on both at x:
//     F = -(1 - s n n^T) (k u + d w),     s = [g < 0],     w = v + omega x r - x',     r = x - origin,
// on the frame, with the moment r x F; -F on x. (The part u x F of the spring's moment is due to the
// rotation of n.) The damper dissipates w^T (1 - s n n^T) w d >= 0. Initially y is such that F = 0, with the
// normal part of u unchanged: there is no jump.
//
// A node carried by a frame (ContactForce::tie) is held with n = 0: E = k/2 |u|^2, and F = -(k u + d w).
//
// Derivatives. With the relative displacement at x, de = dp + dtheta x r - dx, the elastic force rotates with
// the frame (for a common rigid motion de = 0 and dF = dtheta x F), so that
//     dF = -K de + dtheta x F,                     K = k (1 - s n n^T),
//     dM = dr x F + r x dF = dtheta x M - r x K de - de x F,      dr = dtheta x r - de,  M = r x F,
// by Jacobi's identity for dtheta. In addition to Z^T K Z of (dtheta, dp), Z = [-[r]x, I], this gives
//     -dM = [M]x dtheta - [F]x (dp - [r]x dtheta - dx) + ...,    -dF = [F]x dtheta + ...,
// and correspondingly +F on x. The change of the damper's force with position (due to the rotation of n
// and of the arm) is neglected in K: both parts are of the order of d omega. Node-node blocks are symmetric:
// w_i w_j K.
BondForce bond_force(const Vec3& stretch, const Vec3& normal, const Vec3& arm, const Vec3& relative,
                     double stiffness, double damping) {
  const double gap = normal.dot(stretch);
  const bool pressed = gap < 0.0;
  Mat3 P = Mat3::Identity();
  if (pressed) P -= normal * normal.transpose();
  BondForce out;
  out.arm = arm;
  out.elastic = -stiffness * (P * stretch);
  const Vec3 slip = P * relative;
  out.force = out.elastic - damping * slip;
  out.K = stiffness * P;
  out.D = damping * P;
  out.energy = 0.5 * stiffness * (stretch.squaredNorm() - (pressed ? gap * gap : 0.0));
  out.dissipation = damping * slip.squaredNorm();
  return out;
}

BondForce Bonds::force(const Bond& bond, const dynamics::StateView& state,
                       const std::vector<FrameState>& frames) const {
  const FrameState& frame = frames[static_cast<std::size_t>(bond.frame)];
  const PointMotion x = point_motion(bond.held, state, frames);
  const Vec3 arm = x.x - frame.pose.translation;
  return bond_force(frame.R * bond.anchor - arm, frame.R * bond.normal, arm, frame.twist.at(arm) - x.v,
                    bond.stiffness, bond.damping);
}

int Bonds::count() const {
  int count = 0;
  for (const Bond& bond : bonds_) count += bond.pair != Bond::kTied;
  return count;
}

int Bonds::count_of(int frame) const {
  int count = 0;
  for (const Bond& bond : bonds_) count += bond.pair != Bond::kTied && bond.frame == frame;
  return count;
}

double Bonds::area() const {
  double area = 0.0;
  for (const Bond& bond : bonds_) area += bond.pair != Bond::kTied ? bond.area : 0.0;
  return area;
}

void Bonds::tie(int frame, const std::vector<Tie>& ties) {
  PALPATE_CHECK(count() == 0, "ties must be set before grasps, but {} points are already held", count());
  for (const Tie& tie : ties) {
    SurfacePoint held;
    held.count = 1;
    held.node[0] = tie.node;
    held.weight[0] = 1.0;
    bonds_.push_back(
        {held, frame, tie.anchor, Vec3::Zero(), tie.stiffness, tie.damping, 1.0, Bond::kTied, true});
  }
}

// F = 0 where (1 - n n^T) (k u + d w) = 0: u = g n - d/k w projected perpendicular to n.
int Bonds::take(const std::vector<ContactSample>& samples, int frame, const std::vector<PressureLaw>& laws,
                const dynamics::StateView& state, const std::vector<FrameState>& frames) {
  const FrameState& holder = frames[static_cast<std::size_t>(frame)];
  const std::size_t before = bonds_.size();
  for (const ContactSample& s : samples) {
    const bool is_a = s.a.frame == frame, is_b = s.b.frame == frame;
    const SurfacePoint& other = is_a ? s.b : s.a;
    if (is_a == is_b || other.frame >= 0 || !(s.area > 0.0)) continue;
    const SampleMotion motion = sample_motion(s, state, frames);
    const PressureLaw& law = laws[static_cast<std::size_t>(s.source)];
    const Pressure p = pressure(law, motion.gap, motion.rate);
    if (!(p.p > 0.0)) continue;
    const Vec3 n = (is_a ? 1.0 : -1.0) * s.normal;
    const Vec3& x = is_a ? motion.b.x : motion.a.x;
    const Vec3 arm = x - holder.pose.translation;
    const Vec3 w = holder.twist.at(arm) - (is_a ? motion.b.v : motion.a.v);
    const double damping = -p.dp_drate / law.k;  // Damping divided by the stiffness [s].
    const Vec3 u = motion.gap * n - damping * (w - n.dot(w) * n);
    bonds_.push_back({other, frame, holder.R.transpose() * (arm + u), holder.R.transpose() * n,
                      s.area * law.k, s.area * law.k * damping, s.area, s.source, is_a});
  }
  return static_cast<int>(bonds_.size() - before);
}

void Bonds::let_go(int frame) {
  std::erase_if(bonds_,
                [frame](const Bond& bond) { return bond.pair != Bond::kTied && bond.frame == frame; });
}

void Bonds::add_force(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                      const std::vector<int>& rows, VecX& f) const {
  for (const Bond& bond : bonds_) {
    const BondForce b = force(bond, state, frames);
    add_point_force(bond.held, Vec3::Zero(), -b.force, -1, f);
    const int row = rows[static_cast<std::size_t>(bond.frame)];
    if (row < 0) continue;
    f.segment<3>(row) += b.arm.cross(b.force);
    f.segment<3>(row + 3) += b.force;
  }
}

void Bonds::add_resultants(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                           std::vector<Wrench>& on_a) const {
  for (const Bond& bond : bonds_) {
    if (bond.pair == Bond::kTied) continue;
    const BondForce b = force(bond, state, frames);
    const Vec3 x = frames[static_cast<std::size_t>(bond.frame)].pose.translation + b.arm;
    const Vec3 on = bond.frame_is_a ? b.force : Vec3(-b.force);
    on_a[static_cast<std::size_t>(bond.pair)] += Wrench{x.cross(on), on};
  }
}

namespace {

/// Returns Z = [-[r]x, I] of the frame at the held point.
Mat36 at_held(const Vec3& arm) {
  Mat36 Z;
  Z << -cross_matrix(arm), Mat3::Identity();
  return Z;
}

/// Returns -df_x with respect to the frame's motion, for a node of weight 1.
Mat36 by_frame(const Mat3& C, const Vec3& elastic, const Mat36& Z) {
  Mat36 out = -C * Z;
  out.leftCols<3>() -= cross_matrix(elastic);
  return out;
}

/// Returns the frame's rows with respect to the motion of the held point, for a node of weight 1.
Mat63 by_held(const Mat3& C, const Vec3& elastic, const Mat36& Z) {
  Mat63 out = -Z.transpose() * C;
  out.topRows<3>() += cross_matrix(elastic);
  return out;
}

}  // namespace

void Bonds::add_tangent(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                        double k_scale, double d_scale, dynamics::BorderedMatrix& A) const {
  const int nodal = state.layout->nodal_size;
  for (const Bond& bond : bonds_) {
    const BondForce b = force(bond, state, frames);
    const Mat3 C = k_scale * b.K + d_scale * b.D;
    const SurfacePoint& held = bond.held;
    for (int i = 0; i < held.count; ++i)
      for (int j = 0; j < held.count; ++j) {
        const auto ki = static_cast<std::size_t>(i), kj = static_cast<std::size_t>(j);
        const int slot = A.body.slot(held.node[ki], held.node[kj]);
        PALPATE_CHECK(slot >= 0,
                      "a grasp couples nodes {} and {}, which are missing from the pattern of its contact",
                      held.node[ki], held.node[kj]);
        A.body.add(slot, held.weight[ki] * held.weight[kj] * C);
      }
    const int offset = frames[static_cast<std::size_t>(bond.frame)].u_offset;
    if (offset < 0) continue;
    const int at = offset - nodal;
    const Mat36 Z = at_held(b.arm);
    const Vec3 F = k_scale * b.elastic;
    const Mat36 columns = by_frame(C, F, Z);
    const Mat63 rows = by_held(C, F, Z);
    for (std::size_t i = 0; i < static_cast<std::size_t>(held.count); ++i) {
      A.right.block<3, 6>(3 * held.node[i], at) += held.weight[i] * columns;
      A.bottom.block<6, 3>(at, 3 * held.node[i]) += held.weight[i] * rows;
    }
    A.corner.block<6, 6>(at, at) += Z.transpose() * C * Z + turning_part(F, b.arm);
  }
}

void Bonds::apply_tangent(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                          double k_scale, double d_scale, const VecX& x, VecX& y) const {
  for (const Bond& bond : bonds_) {
    const BondForce b = force(bond, state, frames);
    const Mat3 C = k_scale * b.K + d_scale * b.D;
    const Vec3 F = k_scale * b.elastic;
    const Mat36 Z = at_held(b.arm);
    Vec3 dx = Vec3::Zero();
    for (int i = 0; i < bond.held.count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      dx += bond.held.weight[k] * x.segment<3>(3 * bond.held.node[k]);
    }
    Vec3 on_held = C * dx;
    const int offset = frames[static_cast<std::size_t>(bond.frame)].u_offset;
    if (offset >= 0) {
      const Vec6 frame = x.segment<6>(offset);
      on_held += by_frame(C, F, Z) * frame;
      y.segment<6>(offset) +=
          by_held(C, F, Z) * dx + Z.transpose() * (C * (Z * frame)) + turning_part(F, b.arm) * frame;
    }
    add_point_force(bond.held, Vec3::Zero(), on_held, -1, y);
  }
}

void Bonds::add_points(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                       double k_scale, double d_scale, dynamics::PointStiffness& C,
                       dynamics::SparseBorder& border) const {
  for (const Bond& bond : bonds_) {
    const BondForce b = force(bond, state, frames);
    dynamics::PointStiffness::OfPoint point;
    for (int i = 0; i < bond.held.count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      point.nodes.node[k] = bond.held.node[k];
      point.weight[i] = bond.held.weight[k];
    }
    point.nodes.count = bond.held.count;
    point.C = k_scale * b.K + d_scale * b.D;
    C.points.push_back(point);
    const int offset = frames[static_cast<std::size_t>(bond.frame)].u_offset;
    if (offset < 0) continue;
    const int at = offset - state.layout->nodal_size;
    const Mat36 Z = at_held(b.arm);
    const Vec3 F = k_scale * b.elastic;
    for (int i = 0; i < bond.held.count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      dynamics::SparseBorder::Entry& entry = border.at(bond.held.node[k], at);
      entry.right += bond.held.weight[k] * by_frame(point.C, F, Z);
      entry.bottom += bond.held.weight[k] * by_held(point.C, F, Z);
    }
    border.corner.block<6, 6>(at, at) += Z.transpose() * point.C * Z + turning_part(F, b.arm);
  }
}

double Bonds::energy(const dynamics::StateView& state, const std::vector<FrameState>& frames) const {
  double sum = 0.0;
  for (const Bond& bond : bonds_) sum += force(bond, state, frames).energy;
  return sum;
}

double Bonds::dissipation(const dynamics::StateView& state, const std::vector<FrameState>& frames) const {
  double sum = 0.0;
  for (const Bond& bond : bonds_) sum += force(bond, state, frames).dissipation;
  return sum;
}

Wrench Bonds::wrench(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                     int frame) const {
  Wrench sum;
  for (const Bond& bond : bonds_) {
    if (bond.frame != frame) continue;
    const BondForce b = force(bond, state, frames);
    sum += {b.arm.cross(b.force), b.force};
  }
  return sum;
}

void Bonds::linearise(const dynamics::StateView& state, const std::vector<FrameState>& frames, int frame,
                      FrameLinearisation& out) const {
  for (const Bond& bond : bonds_) {
    if (bond.frame != frame) continue;
    const BondForce b = force(bond, state, frames);
    const Mat36 Z = at_held(b.arm);
    const Mat6 turning = turning_part(b.elastic, b.arm);
    out.wrench += {b.arm.cross(b.force), b.force};
    out.K += Z.transpose() * b.K * Z + turning;
    out.geometric -= turning.topLeftCorner<3, 3>();
    out.B += Z.transpose() * b.D * Z;
    const Mat36 columns_k = by_frame(b.K, b.elastic, Z), columns_b = by_frame(b.D, Vec3::Zero(), Z);
    const Mat63 rows_k = by_held(b.K, b.elastic, Z), rows_b = by_held(b.D, Vec3::Zero(), Z);
    for (std::size_t i = 0; i < static_cast<std::size_t>(bond.held.count); ++i) {
      const double w = bond.held.weight[i];
      const int at = 3 * bond.held.node[i];
      out.K_body.middleRows<3>(at) += w * columns_k;
      out.B_body.middleRows<3>(at) += w * columns_b;
      out.K_frame.middleCols<3>(at) += w * rows_k;
      out.B_frame.middleCols<3>(at) += w * rows_b;
    }
    ++out.active;
  }
}

void Bonds::append_reduced_samples(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                                   int frame, std::vector<ReducedSample>& out,
                                   std::vector<ReducedTangent>* tangents) const {
  for (const Bond& bond : bonds_) {
    if (bond.frame != frame) continue;
    const BondForce b = force(bond, state, frames);
    const FrameState& holder = frames[static_cast<std::size_t>(frame)];
    const PointMotion x = point_motion(bond.held, state, frames);
    const Vec3 normal = holder.R * bond.normal;
    out.push_back({.offset = bond.anchor,
                   .slide = Vec3::Zero(),
                   .count = bond.held.count,
                   .node = bond.held.node,
                   .weight = bond.held.weight,
                   .normal = normal,
                   .place = x.x,
                   .velocity = x.v,
                   .area = bond.area,
                   .gap = normal.dot(holder.R * bond.anchor - b.arm),
                   .pair = bond.pair,
                   .stiffness = bond.stiffness,
                   .force = b.force,
                   .held = true,
                   .damping = bond.damping});
    if (tangents) tangents->push_back({b.K, b.D});
  }
}

namespace {

void archive_point(Archive& a, SurfacePoint& point) {
  a("frame", point.frame);
  a("count", point.count);
  a.each("node", point.node, [&](int& node) { a("n", node); });
  a.numbers("weight", point.weight);
  a("offset", point.offset);
  a("slide", point.slide);
}

}  // namespace

/// Saves or restores the held points. Ties come from the scene: they precede held points in the list and are
/// kept.
void Bonds::archive(Archive& a) {
  const auto first =
      std::find_if(bonds_.begin(), bonds_.end(), [](const Bond& bond) { return bond.pair != Bond::kTied; });
  std::vector<Bond> grasped(first, bonds_.end());
  a.list("bond", grasped, [&](Bond& bond) {
    {
      const Archive::Group group(a, "held");
      archive_point(a, bond.held);
    }
    a("frame", bond.frame);
    a("anchor", bond.anchor);
    a("normal", bond.normal);
    a("stiffness", bond.stiffness);
    a("damping", bond.damping);
    a("area", bond.area);
    a("pair", bond.pair);
    a("frame_is_a", bond.frame_is_a);
  });
  bonds_.erase(first, bonds_.end());
  bonds_.insert(bonds_.end(), grasped.begin(), grasped.end());
}

}  // namespace palpate::contact
