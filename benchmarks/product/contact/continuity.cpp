#include "product/continuity.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "palpate/contact/contact_force.h"
#include "palpate/core/error.h"
#include "palpate/loop/run.h"
#include "product/contact/relative_path.h"

namespace palpate::bench {
namespace {

constexpr double kTurn = 0.2;   // Rotation of the body before a path [rad].
constexpr double kFloor = 0.1;  // Smallest reference of a change, over the path's largest force.

/// Contact at one pose: wrench on the moved body about the pivot, and the location of contact.
struct Contact {
  Wrench wrench;
  double volume = 0.0;         // Overlap volume [m^3].
  Vec3 centre = Vec3::Zero();  // Its centre [m].
};

/// World whose last body is moved rigidly.
class Probe {
 public:
  explicit Probe(const scene::Description& d) : world_(loop::assemble(d)) {
    if (world_->bodies.empty() || !world_->contact || (world_->bodies.size() < 2 && !d.tool))
      fail(
          "bench continuity: scene \"{}\" has neither a second body nor a tool; its last body needs one to "
          "move against",
          d.name);
    world_->state.u().setZero();
    placed_ = world_->positions(world_->bodies.back());
    partner_ = world_->bodies.size() > 1 ? Vec3(world_->positions(world_->bodies.front()).rowwise().mean())
                                         : world_->tool_pose().translation;
  }

  Vec3 middle() const { return placed_.rowwise().mean(); }
  const Vec3& partner() const { return partner_; }
  long queries() const { return world_->contact->statistics().queries; }

  Contact at(const Pose& pose, const Vec3& pivot) {
    const dynamics::Block& block = *world_->state.layout().find(world_->bodies.back().block_id);
    auto q = world_->state.q(block);
    for (Eigen::Index i = 0; i < placed_.cols(); ++i) q.segment<3>(3 * i) = pose * Vec3(placed_.col(i));
    const dynamics::StateView state = world_->state.view();
    world_->refresh_contact();
    force_.setZero(state.layout->u_size);
    world_->contact->add_force(state, force_);
    Contact out;
    for (Eigen::Index i = 0; i < placed_.cols(); ++i) {
      const Vec3 f = force_.segment<3>(block.u_offset + 3 * i);
      out.wrench.force += f;
      out.wrench.moment += (Vec3(q.segment<3>(3 * i)) - pivot).cross(f);
    }
    measure(state, out);
    return out;
  }

 private:
  void measure(const dynamics::StateView& state, Contact& out) const {
    for (const contact::ContactSample& s : world_->contact->samples()) {
      if (s.gap >= 0.0) continue;
      const double volume = -s.gap * s.area;
      const contact::SurfacePoint& soft = s.a.frame < 0 ? s.a : s.b;
      for (int i = 0; i < soft.count; ++i)
        out.centre += volume * soft.weight[static_cast<std::size_t>(i)] *
                      state.position(soft.node[static_cast<std::size_t>(i)]);
      out.volume += volume;
    }
    if (out.volume > 0.0) out.centre /= out.volume;
  }

  std::unique_ptr<loop::World> world_;
  Points placed_;
  Vec3 partner_;
  VecX force_;
};

/// Approaches from far away, along the line of both centres, to the first touch.
class Approach {
 public:
  explicit Approach(Probe& probe) : probe_(probe) {
    const Vec3 line = probe.middle() - probe.partner();
    reach_ = line.norm();
    if (!(reach_ > 0.0)) fail("bench continuity: the bodies have the same centre");
    inside_ = first_touch(Pose{}, line / reach_) > 0.02;
  }

  std::optional<Meeting> meet(std::mt19937& random) {
    const Quat turn = quaternion_of(random_rotation(random, inside_ ? 0.0 : kTurn));
    const Vec3 middle = probe_.middle();
    Meeting m;
    m.away = (middle - probe_.partner()).normalized();
    m.reach = reach_;
    m.inside = inside_;
    m.start = {turn, middle - turn * middle};
    if (!inside_) {
      const double s = first_touch(m.start, m.away);
      if (!std::isfinite(s)) return std::nullopt;
      m.start.translation += s * reach_ * m.away;
    }
    Contact touch = probe_.at(m.start, middle);
    for (int i = 0; i < kDeeper && touch.volume == 0.0; ++i) {
      m.start.translation -= 0.1 * kStep * reach_ * m.away;
      touch = probe_.at(m.start, middle);
    }
    if (touch.volume == 0.0) return std::nullopt;
    m.pivot = touch.centre;
    return m;
  }

 private:
  /// Returns the largest distance at which they still touch, over the reach; minus infinity if they do not.
  double first_touch(const Pose& start, const Vec3& away) {
    const auto touches = [&](double s) {
      return !probe_.at({start.rotation, start.translation + s * reach_ * away}, Vec3::Zero())
                  .wrench.force.isZero(0.0);
    };
    double s = 0.6;
    while (s > -0.9 && !touches(s)) s -= kStep;
    if (s <= -0.9) return -std::numeric_limits<double>::infinity();
    double apart = s + kStep;
    for (int i = 0; i < 5; ++i) {
      const double middle = 0.5 * (s + apart);
      (touches(middle) ? s : apart) = middle;
    }
    return s;
  }

  static constexpr double kStep = 0.01;  // Fraction of the reach.
  static constexpr int kDeeper = 3;
  Probe& probe_;
  double reach_ = 0.0;
  bool inside_ = false;
};

/// Changes between two poses, relative to the sizes of force and moment.
struct Change {
  double force = 0.0, moment = 0.0;
  double size = 0.0;  ///< Size of the force [N].
};

struct Scale {
  double force = 0.0, arm = 0.0;
  Change change(const Contact& p, const Contact& q) const {
    const double size = std::max({p.wrench.force.norm(), q.wrench.force.norm(), kFloor * force});
    if (!(size > 0.0)) return {};
    return {(q.wrench.force - p.wrench.force).norm() / size,
            (q.wrench.moment - p.wrench.moment).norm() / (size * arm), size};
  }
};

class Walk {
 public:
  Walk(Probe& probe, const ContinuityOptions& options, ContinuityRow& row)
      : probe_(probe), options_(options), row_(row) {}

  void along(const RelativePath& path, const Meeting& meeting, int number) {
    path_ = &path;
    pivot_ = meeting.pivot;
    contacts_.clear();
    for (int i = 0; i <= options_.steps; ++i) contacts_.push_back(at(time(i)));
    scale_ = {.force = 0.0, .arm = 0.1 * meeting.reach};
    for (const Contact& c : contacts_) scale_.force = std::max(scale_.force, c.wrench.force.norm());
    if (scale_.force == 0.0) return;
    row_.force = std::max(row_.force, scale_.force);
    double worst = 0.0;
    for (int i = 0; i < options_.steps; ++i) {
      const auto k = static_cast<std::size_t>(i);
      row_.steps += contacts_[k].volume > 0.0 || contacts_[k + 1].volume > 0.0;
      if (scale_.change(contacts_[k], contacts_[k + 1]).force < options_.threshold) continue;
      ForceJump jump = halve(i);
      jump.path = number;
      worst = std::max(worst, jump.force);
      row_.jumps.push_back(jump);
    }
    row_.worst_of_path.push_back(worst);
  }

 private:
  double time(int i) const { return static_cast<double>(i) / options_.steps; }
  Contact at(double s) { return probe_.at(path_->at(s), pivot_); }

  /// Bisects a step repeatedly into the half with the greater change. The steps before it are repeated to
  /// reach it; if this yields another force, the force depends on the path.
  ForceJump halve(int step) {
    Contact before;
    for (int i = std::max(0, step - 2); i <= step; ++i) before = at(time(i));
    const Contact& first = contacts_[static_cast<std::size_t>(step)];
    if (const Change c = scale_.change(first, before); c.force > options_.threshold)
      return {.at = time(step), .force = c.force, .moment = c.moment, .size_n = c.size, .by_history = true};
    Contact after = contacts_[static_cast<std::size_t>(step) + 1];
    double low = time(step), high = time(step + 1);
    for (int i = 0; i < options_.halvings; ++i) {
      const double s = 0.5 * (low + high);
      const Contact middle = at(s);
      if (scale_.change(before, middle).force >= scale_.change(middle, after).force) {
        after = middle;
        high = s;
      } else {
        before = middle;
        low = s;
      }
    }
    const Change c = scale_.change(before, after);
    return {.at = low, .force = c.force, .moment = c.moment, .size_n = c.size};
  }

  Probe& probe_;
  const ContinuityOptions& options_;
  ContinuityRow& row_;
  const RelativePath* path_ = nullptr;
  Vec3 pivot_ = Vec3::Zero();
  Scale scale_;
  std::vector<Contact> contacts_;
};

}  // namespace

ContinuityRow bench_continuity(scene::Description d, const ContinuityOptions& options,
                               const std::atomic<bool>* stop) {
  bool any = false;
  for (ContactSpec& contact : d.contacts) {
    if (std::any_of(d.obstacles.begin(), d.obstacles.end(),
                    [&](const ObstacleSpec& o) { return o.name == contact.second; }))
      continue;
    contact.method = options.method;
    contact.quadrature_error = options.quadrature_error;
    any = true;
  }
  if (!any) fail("bench continuity: scene \"{}\" has no contact with a tool or between bodies", d.name);
  d.record.reset();
  Probe probe(d);
  Approach approach(probe);
  std::mt19937 random(options.seed);
  ContinuityRow row;
  Walk walk(probe, options, row);
  for (int i = 0; i < options.paths && !(stop && *stop); ++i) {
    const auto meeting = approach.meet(random);
    if (!meeting) continue;
    walk.along(RelativePath(*meeting, random), *meeting, i);
    ++row.paths;
  }
  row.queries = probe.queries();
  return row;
}

}  // namespace palpate::bench
