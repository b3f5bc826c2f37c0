#include "contact/sample_groups.h"

#include <algorithm>

#include "palpate/core/error.h"

// Of one group, with n its normal, w_i the weights of a's nodes x_i, and side b a frame at (p, R) with twist
// (w, v), its points o in the frame's axes, slide s along n:
//
//     gap  = sum w_i (n . x_i) + c - n . p - (R^T n) . o - s
//     rate = sum w_i (n . v_i) - n . v - (R^T (n x w)) . o                      as n . (w x r) = r . (n x w)
//
// With f = A p, k = -A dp/dgap, d = -A dp/drate of each sample, forces are
//
//     on node i  (sum f w_i) n,      on the frame  -(sum f) n  and the moment  -(R sum f o) x n,
//
// since s is parallel to n.  The frame's map Z of a point's motion (tangent.h) and V of its velocity by a
// rotation with the twist held enter through n alone, both linear in o:
//
//     z = Z^T n = (R o x n, n) = (L o, n),  L = -[n]x R,      v = V^T n = -R o x (w x n) = M o,  M = [w x n]x
//     R.
//
// So the blocks of the tangent are, with S0, S1, S2 = sum k (1, o, o o^T) and the like with d:
//
//     node i, node j       (sum k w_i w_j) n n^T
//     node i, frame        -n (sum k w_i z + sum d w_i v)^T
//     frame, frame          sum k z z^T + sum d z (v, 0)^T   + sum f [n]x [R o]x
//
// the last being the moment's change with its own arm (tangent.cpp).

namespace palpate::contact {
namespace {

using Vec4 = Eigen::Vector4d;
using Mat34 = Eigen::Matrix<double, 3, 4>;

std::size_t hash_of(const ContactSample& s) {
  std::size_t h = static_cast<std::size_t>(s.b.frame + 1);
  for (int i = 0; i < s.a.count; ++i)
    h = h * 1000003u + static_cast<std::size_t>(s.a.node[static_cast<std::size_t>(i)]);
  if (s.b.frame < 0)
    for (int i = 0; i < s.b.count; ++i)
      h = h * 1000003u + static_cast<std::size_t>(s.b.node[static_cast<std::size_t>(i)]);
  return h ^ (h >> 17);
}

Vec4 weights(const SurfacePoint& point) {
  Vec4 out = Vec4::Zero();
  for (int i = 0; i < point.count; ++i) out[i] = point.weight[static_cast<std::size_t>(i)];
  return out;
}

/// sum c (1, o, o o^T) over samples, and sum c w_i (1, o).
struct Moments {
  double zero = 0.0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  Vec4 weights = Vec4::Zero();
  Mat34 points = Mat34::Zero();

  void add(double c, const Vec3& o, const Vec4& w) {
    const Vec3 co = c * o;
    zero += c;
    first += co;
    second.noalias() += co * o.transpose();
    weights += c * w;
    points.noalias() += co * w.transpose();
  }
};

/// What a frame's side makes of n: see above.
struct FrameMaps {
  Vec3 n;
  Mat3 R, L, M;
  FrameMaps(const Vec3& normal, const FrameState& frame)
      : n(normal),
        R(frame.R),
        L(-cross_matrix(normal) * frame.R),
        M(cross_matrix(frame.twist.angular.cross(normal)) * frame.R) {}
  /// sum c w_i z
  Vec6 z(const Moments& m, int i) const {
    Vec6 out;
    out << L * m.points.col(i), m.weights[i] * n;
    return out;
  }
  /// sum c z z^T
  Mat6 zz(const Moments& m) const {
    Mat6 out;
    const Vec3 l = L * m.first;
    out.topLeftCorner<3, 3>().noalias() = L * m.second * L.transpose();
    out.topRightCorner<3, 3>().noalias() = l * n.transpose();
    out.bottomLeftCorner<3, 3>().noalias() = n * l.transpose();
    out.bottomRightCorner<3, 3>().noalias() = m.zero * n * n.transpose();
    return out;
  }
  /// sum c z v^T
  Eigen::Matrix<double, 6, 3> zv(const Moments& m) const {
    Eigen::Matrix<double, 6, 3> out;
    out.topRows<3>().noalias() = L * m.second * M.transpose();
    out.bottomRows<3>().noalias() = n * (M * m.first).transpose();
    return out;
  }
  /// sum f [n]x [R o]x
  Mat3 rotating_moment(const Vec3& sum_fo) const { return cross_matrix(n) * cross_matrix(R * sum_fo); }
};

}  // namespace

void SampleGroups::clear() {
  groups_.clear();
  samples_.clear();
}

bool SampleGroups::belongs(const Group& group, const ContactSample& s) const {
  if (group.frame != s.b.frame || group.count_a != s.a.count) return false;
  for (std::size_t i = 0; i < static_cast<std::size_t>(s.a.count); ++i)
    if (group.a[i] != s.a.node[i]) return false;
  if (s.b.frame >= 0) return true;
  if (group.count_b != s.b.count) return false;
  for (std::size_t i = 0; i < static_cast<std::size_t>(s.b.count); ++i)
    if (group.b[i] != s.b.node[i]) return false;
  return true;
}

/// By open addressing; `table_` holds the groups of this run of samples, which share a normal.
int SampleGroups::group_of(const ContactSample& s, const PressureLaw& law, std::size_t first_of_run) {
  const std::size_t mask = table_.size() - 1;
  for (std::size_t at = hash_of(s) & mask;; at = (at + 1) & mask) {
    int& entry = table_[at];
    if (entry >= static_cast<int>(first_of_run)) {
      if (belongs(groups_[static_cast<std::size_t>(entry)], s)) return entry;
      continue;
    }
    entry = static_cast<int>(groups_.size());
    Group group;
    group.pair = s.source;
    group.frame = s.b.frame;
    group.count_a = s.a.count;
    group.a = s.a.node;
    if (s.b.frame < 0) group.count_b = s.b.count, group.b = s.b.node;
    group.normal = s.normal;
    group.law = law;
    groups_.push_back(group);
    return entry;
  }
}

void SampleGroups::append(std::span<const ContactSample> samples, const PressureLaw& law) {
  std::size_t size = 16;
  while (size < 2 * samples.size()) size *= 2;
  table_.assign(size, -1);
  group_of_sample_.resize(samples.size());
  const std::size_t first_group = groups_.size();
  std::size_t first_of_run = first_group;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    PALPATE_CHECK(samples[i].a.frame < 0, "a contact sample has a frame on its first side");
    if (i > 0 && samples[i].normal != samples[i - 1].normal) first_of_run = groups_.size();
    // neighbours in a row of pixels mostly share their nodes: no search
    const int last = i > 0 ? group_of_sample_[i - 1] : -1;
    group_of_sample_[i] =
        last >= static_cast<int>(first_of_run) && belongs(groups_[static_cast<std::size_t>(last)], samples[i])
            ? last
            : group_of(samples[i], law, first_of_run);
  }
  fill(samples, first_group);
}

/// Sorts the samples by group, in their own order within each.
void SampleGroups::fill(std::span<const ContactSample> samples, std::size_t first_group) {
  const std::size_t before = samples_.size();
  samples_.resize(before + samples.size());
  for (const int g : group_of_sample_) ++groups_[static_cast<std::size_t>(g)].last;
  int next = static_cast<int>(before);
  for (std::size_t g = first_group; g < groups_.size(); ++g) {
    const int count = groups_[g].last;
    groups_[g].first = groups_[g].last = next;
    next += count;
  }
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const ContactSample& s = samples[i];
    Group& group = groups_[static_cast<std::size_t>(group_of_sample_[i])];
    Sample& at = samples_[static_cast<std::size_t>(group.last++)];
    at.a = weights(s.a);
    if (s.b.frame < 0)
      at.b = weights(s.b);
    else
      at.b << s.b.offset, 0.0;
    at.area = s.area;
    at.shift = s.normal.dot(s.a.offset - (s.b.frame < 0 ? s.b.offset : s.b.slide));
  }
}

template <class Visit>
void SampleGroups::for_each_pressed(const Group& group, const dynamics::StateView& state,
                                    const std::vector<FrameState>& frames, Visit visit) const {
  const Vec3& n = group.normal;
  Vec4 xa = Vec4::Zero(), va = Vec4::Zero(), xb = Vec4::Zero(), vb = Vec4::Zero();
  double x0 = 0.0, v0 = 0.0;
  for (int i = 0; i < group.count_a; ++i) {
    xa[i] = n.dot(state.position(group.a[static_cast<std::size_t>(i)]));
    va[i] = n.dot(state.velocity(group.a[static_cast<std::size_t>(i)]));
  }
  if (group.frame >= 0) {
    const FrameState& frame = frames[static_cast<std::size_t>(group.frame)];
    xb.head<3>() = frame.R.transpose() * n;
    vb.head<3>() = frame.R.transpose() * n.cross(frame.twist.angular);
    x0 = n.dot(frame.pose.translation);
    v0 = n.dot(frame.twist.linear);
  }
  for (int i = 0; group.frame < 0 && i < group.count_b; ++i) {
    xb[i] = n.dot(state.position(group.b[static_cast<std::size_t>(i)]));
    vb[i] = n.dot(state.velocity(group.b[static_cast<std::size_t>(i)]));
  }
  for (int i = group.first; i < group.last; ++i) {
    const Sample& s = samples_[static_cast<std::size_t>(i)];
    const double gap = s.a.dot(xa) - s.b.dot(xb) - x0 + s.shift;
    if (gap >= 0.0) continue;
    const Pressure p = pressure(group.law, gap, s.a.dot(va) - s.b.dot(vb) - v0);
    visit(s, Response{s.area * p.p, -s.area * p.dp_dgap, -s.area * p.dp_drate});
  }
}

void SampleGroups::add_force(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                             const std::vector<int>& frame_row, VecX& f, std::vector<Wrench>* resultants) {
  for (const Group& group : groups_) {
    Vec4 on_a = Vec4::Zero(), on_b = Vec4::Zero();
    double sum = 0.0;
    for_each_pressed(group, state, frames, [&](const Sample& s, const Response& r) {
      on_a += r.force * s.a;
      on_b += r.force * s.b;
      sum += r.force;
    });
    if (sum == 0.0) continue;
    if (resultants) {
      Vec3 moment = Vec3::Zero();
      for (int i = 0; i < group.count_a; ++i)
        moment += on_a[i] * state.position(group.a[static_cast<std::size_t>(i)]);
      (*resultants)[static_cast<std::size_t>(group.pair)] +=
          Wrench{moment.cross(group.normal), sum * group.normal};
    }
    for (int i = 0; i < group.count_a; ++i)
      f.segment<3>(3 * group.a[static_cast<std::size_t>(i)]) += on_a[i] * group.normal;
    if (group.frame < 0) {
      for (int i = 0; i < group.count_b; ++i)
        f.segment<3>(3 * group.b[static_cast<std::size_t>(i)]) -= on_b[i] * group.normal;
    } else if (const int row = frame_row[static_cast<std::size_t>(group.frame)]; row >= 0) {
      const Mat3& R = frames[static_cast<std::size_t>(group.frame)].R;
      f.segment<3>(row) -= (R * on_b.head<3>()).cross(group.normal);
      f.segment<3>(row + 3) -= sum * group.normal;
    }
  }
}

namespace {

/// A += scales[i][j] n n^T at blocks (p_i, q_j).
void add_blocks(const std::array<int, 4>& p, int p_count, const std::array<int, 4>& q, int q_count,
                const Eigen::Matrix4d& scales, const Mat3& nn, dynamics::BorderedMatrix& A) {
  for (int i = 0; i < p_count; ++i)
    for (int j = 0; j < q_count; ++j) {
      const int row = p[static_cast<std::size_t>(i)], column = q[static_cast<std::size_t>(j)];
      const int slot = A.body.slot(row, column);
      PALPATE_CHECK(slot >= 0,
                    "contact couples nodes {} and {}, which its source did not announce in add_pattern", row,
                    column);
      A.body.add(slot, scales(i, j) * nn);
    }
}

}  // namespace

void SampleGroups::add_tangent(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                               double k_scale, double d_scale, dynamics::BorderedMatrix& A) {
  using Mat4 = Eigen::Matrix4d;
  for (const Group& group : groups_) {
    const bool nodes = group.frame < 0;
    const int offset = nodes ? -1 : frames[static_cast<std::size_t>(group.frame)].u_offset;
    Mat4 aa = Mat4::Zero(), ab = Mat4::Zero(), bb = Mat4::Zero();
    Moments c, damping;
    Vec3 forces = Vec3::Zero();
    bool any = false;
    for_each_pressed(group, state, frames, [&](const Sample& s, const Response& r) {
      const double scale = k_scale * r.k + d_scale * r.d;
      any = true;
      const Vec4 scaled = scale * s.a;
      aa.noalias() += scaled * s.a.transpose();
      if (nodes) {
        ab.noalias() += scaled * s.b.transpose();
        bb.noalias() += scale * s.b * s.b.transpose();
      } else if (offset >= 0) {
        c.add(scale, s.b.head<3>(), s.a);
        damping.add(k_scale * r.d, s.b.head<3>(), s.a);
        forces += k_scale * r.force * s.b.head<3>();
      }
    });
    if (!any) continue;
    const Vec3& n = group.normal;
    const Mat3 nn = n * n.transpose();
    add_blocks(group.a, group.count_a, group.a, group.count_a, aa, nn, A);
    if (nodes) {
      add_blocks(group.a, group.count_a, group.b, group.count_b, -ab, nn, A);
      add_blocks(group.b, group.count_b, group.a, group.count_a, -ab.transpose(), nn, A);
      add_blocks(group.b, group.count_b, group.b, group.count_b, bb, nn, A);
    }
    if (offset < 0) continue;
    const int at = offset - state.layout->nodal_size;
    const FrameMaps maps(n, frames[static_cast<std::size_t>(group.frame)]);
    for (int i = 0; i < group.count_a; ++i) {
      const int node = 3 * group.a[static_cast<std::size_t>(i)];
      const Vec6 z = maps.z(c, i);
      A.bottom.block<6, 3>(at, node).noalias() -= z * n.transpose();
      A.right.block<3, 6>(node, at).noalias() -= n * z.transpose();
      A.right.block<3, 3>(node, at).noalias() -= n * (maps.M * damping.points.col(i)).transpose();
    }
    A.corner.block<6, 6>(at, at) += maps.zz(c);
    A.corner.block<6, 3>(at, at) += maps.zv(damping);
    A.corner.block<3, 3>(at, at) += maps.rotating_moment(forces);
  }
}

// With both sides' weights in one vector, w = (w_a, -w_b) or w_a alone, the group's share is
// (sum (k_scale k + d_scale d) w w^T) x n n^T.
void SampleGroups::add_stiffness(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                                 double k_scale, double d_scale, dynamics::PointStiffness& C) {
  for (const Group& group : groups_) {
    dynamics::PointStiffness::AlongNormal out;
    dynamics::PointStiffness::Nodes& nodes = out.nodes;
    const int count_b = group.frame < 0 ? group.count_b : 0;
    nodes.count = group.count_a + count_b;
    nodes.relative = count_b > 0;
    for (int i = 0; i < nodes.count; ++i)
      nodes.node[static_cast<std::size_t>(i)] = i < group.count_a
                                                    ? group.a[static_cast<std::size_t>(i)]
                                                    : group.b[static_cast<std::size_t>(i - group.count_a)];
    bool any = false;
    dynamics::PointStiffness::Weights w = dynamics::PointStiffness::Weights::Zero();
    for_each_pressed(group, state, frames, [&](const Sample& s, const Response& r) {
      any = true;
      w.head(group.count_a) = s.a.head(group.count_a);
      w.segment(group.count_a, count_b) = -s.b.head(count_b);
      out.G.noalias() += (k_scale * r.k + d_scale * r.d) * w * w.transpose();
    });
    if (!any) continue;
    out.normal = group.normal;
    C.along.push_back(out);
  }
}

void SampleGroups::apply_tangent(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                                 double k_scale, double d_scale, const VecX& x, VecX& y) {
  for (const Group& group : groups_) {
    const Vec3& n = group.normal;
    const FrameState* frame = group.frame < 0 ? nullptr : &frames[static_cast<std::size_t>(group.frame)];
    const int offset = frame ? frame->u_offset : -1;
    Vec4 along_a = Vec4::Zero(), along_b = Vec4::Zero();  // n . x, by which the gap changes
    double shift = 0.0;
    Vec3 turned = Vec3::Zero();  // by which the gap's rate changes, times o
    for (int i = 0; i < group.count_a; ++i)
      along_a[i] = n.dot(x.segment<3>(3 * group.a[static_cast<std::size_t>(i)]));
    for (int i = 0; !frame && i < group.count_b; ++i)
      along_b[i] = n.dot(x.segment<3>(3 * group.b[static_cast<std::size_t>(i)]));
    const FrameMaps maps(n, frame ? *frame : FrameState{});
    if (offset >= 0) {
      along_b.head<3>() = maps.L.transpose() * x.segment<3>(offset);
      shift = n.dot(x.segment<3>(offset + 3));
      turned = maps.M.transpose() * x.segment<3>(offset);
    }
    Vec4 on_a = Vec4::Zero(), on_b = Vec4::Zero();
    double sum = 0.0;
    Vec3 forces = Vec3::Zero();
    bool any = false;
    for_each_pressed(group, state, frames, [&](const Sample& s, const Response& r) {
      const double dx = s.a.dot(along_a) - s.b.dot(along_b) - shift, dv = -s.b.head<3>().dot(turned);
      const double g = k_scale * (r.k * dx + r.d * dv) + d_scale * r.d * dx;
      on_a += g * s.a;
      on_b += g * s.b;
      sum += g;
      forces += k_scale * r.force * s.b.head<3>();
      any = true;
    });
    if (!any) continue;
    for (int i = 0; i < group.count_a; ++i)
      y.segment<3>(3 * group.a[static_cast<std::size_t>(i)]) += on_a[i] * n;
    for (int i = 0; !frame && i < group.count_b; ++i)
      y.segment<3>(3 * group.b[static_cast<std::size_t>(i)]) -= on_b[i] * n;
    if (offset < 0) continue;
    y.segment<3>(offset) -= maps.L * on_b.head<3>();
    y.segment<3>(offset + 3) -= sum * n;
    y.segment<3>(offset) += maps.rotating_moment(forces) * x.segment<3>(offset);
  }
}

void SampleGroups::linearise(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                             int frame, FrameLinearisation& out) {
  for (const Group& group : groups_) {
    if (group.frame != frame) continue;
    Moments k, d;
    Vec3 forces = Vec3::Zero();
    double sum = 0.0;
    int active = 0;
    for_each_pressed(group, state, frames, [&](const Sample& s, const Response& r) {
      if (r.force == 0.0) return;
      k.add(r.k, s.b.head<3>(), s.a);
      d.add(r.d, s.b.head<3>(), s.a);
      forces += r.force * s.b.head<3>();
      sum += r.force;
      ++active;
    });
    if (active == 0) continue;
    out.active += active;
    const Vec3& n = group.normal;
    const FrameMaps maps(n, frames[static_cast<std::size_t>(frame)]);
    const Mat3 moment = maps.rotating_moment(forces);
    out.wrench.force -= sum * n;
    out.wrench.moment -= (maps.R * forces).cross(n);
    out.K += maps.zz(k);
    out.K.leftCols<3>() += maps.zv(d);
    out.K.topLeftCorner<3, 3>() += moment;
    out.geometric -= moment;
    out.B += maps.zz(d);
    for (int i = 0; i < group.count_a; ++i) {
      const int node = 3 * group.a[static_cast<std::size_t>(i)];
      const Vec6 zk = maps.z(k, i), zd = maps.z(d, i);
      out.K_body.middleRows<3>(node).noalias() -= n * zk.transpose();
      out.K_body.block<3, 3>(node, 0).noalias() -= n * (maps.M * d.points.col(i)).transpose();
      out.B_body.middleRows<3>(node).noalias() -= n * zd.transpose();
      out.K_frame.middleCols<3>(node).noalias() -= zk * n.transpose();
      out.B_frame.middleCols<3>(node).noalias() -= zd * n.transpose();
    }
  }
}

}  // namespace palpate::contact
