#include <algorithm>

#include "core/clock.h"
#include "palpate/core/error.h"
#include "palpate/loop/run.h"
#include "product/contact.h"
#include "product/contact/statistics.h"

namespace palpate::bench {
namespace {

constexpr double kInteractive = 1e-3;  ///< Tolerance of an interactive step's linear solve.
constexpr double kFriction = 0.3;
const Vec3 kGravity(0, 0, -9.81);

/// Records the run time of each period of a scene without contact [ms].
class PeriodTimes : public loop::Observer {
 public:
  void period(loop::World&, double) override {
    const double now = wall_seconds();
    if (last_ > 0.0) ms_.push_back(1e3 * (now - last_));
    last_ = wall_seconds();
  }
  /// Returns the median without the first period, which includes the symbolic analysis.
  double median_ms() const {
    return ms_.size() < 2 ? 0.0 : median(std::vector<double>(ms_.begin() + 1, ms_.end()));
  }

 private:
  double last_ = 0.0;
  std::vector<double> ms_;
};

/// Measures the bodies alone, falling under their weight as far as they are not held: at rest there is
/// nothing to solve.
double bodies_alone_ms(scene::Description d, const std::atomic<bool>* stop) {
  RecordSpec record;  // Records nothing, but sets the loop's period without contact.
  record.states = false;
  record.state_period_s = loop::period_of(d);
  d.record = record;
  d.contacts.clear();
  d.obstacles.clear();
  d.tool.reset();
  d.device.reset();
  d.gravity_m_s2 = kGravity;
  d.integrator.threads = 1;
  const auto world = loop::assemble(d);
  PeriodTimes times;
  loop::RunOptions options;
  options.observers = {&times};
  options.stop = stop;
  const loop::RunResult result = loop::run(*world, options);
  if (!result.status.ok()) fail("bench contact: {}", result.status.message);
  return times.median_ms();
}

/// Returns the largest |F_symmetric - F_full| at equal times over the largest |F_full|; both runs have the
/// same periods.
double largest_change(const std::vector<Vec3>& symmetric, const std::vector<Vec3>& full) {
  double change = 0.0, size = 0.0;
  for (std::size_t i = 0; i < std::min(symmetric.size(), full.size()); ++i) {
    change = std::max(change, (symmetric[i] - full[i]).norm());
    size = std::max(size, full[i].norm());
  }
  return size > 0.0 ? change / size : 0.0;
}

FrictionPrice friction_price(scene::Description d, const std::atomic<bool>* stop) {
  const auto run = [&](FrictionTangent tangent) {
    for (ContactSpec& contact : d.contacts) {
      contact.friction = kFriction;
      contact.friction_tangent = tangent;
    }
    return bench_contact(d, {}, stop);
  };
  const ContactBenchRow symmetric = run(FrictionTangent::kSecant), full = run(FrictionTangent::kFull);
  FrictionPrice out{.symmetric_ms = symmetric.step.median, .full_ms = full.step.median};
  if (symmetric.friction_n > 0.0) out.left_out = symmetric.left_out_n / symmetric.friction_n;
  out.force_change = largest_change(symmetric.forces, full.forces);
  return out;
}

}  // namespace

ContactCost bench_contact_price(const scene::Description& d, const std::atomic<bool>* stop) {
  ContactCost out;
  out.scene = d.name;
  out.row = bench_contact(d, {}, stop);
  if (!d.tool && out.row.touches) out.friction = friction_price(d, stop);
  out.contact_free_ms = bodies_alone_ms(d, stop);
  for (const SoftBodySpec& body : d.bodies) {
    scene::Description alone = d;
    alone.bodies = {body};
    out.bodies_ms += bodies_alone_ms(alone, stop);
    if (out.one_body_ms > 0.0) continue;
    alone.integrator.linear_rtol = kInteractive;
    out.one_body_ms = bodies_alone_ms(alone, stop);
  }
  return out;
}

}  // namespace palpate::bench
