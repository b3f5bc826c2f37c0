#include <unistd.h>

#include <cmath>
#include <complex>
#include <filesystem>

#include "cases.h"
#include "image_backends.h"
#include "palpate/core/error.h"
#include "palpate/loop/run.h"
#include "palpate/mesh/generators.h"
#include "palpate/store/model_file.h"

// A round tool of radius R is dragged at speed v over a block of a few tetrahedra whose skin is corrugated,
// z = a sin(q x).  The tetrahedra and their own surface are flat: only the skin knows of the corrugation.
//
// Volume law.  With the tool's lowest point delta below the mean surface, at x, the depth at (xi, eta) from
// its axis is h(r) + a sin(q (x + xi)), h = sqrt(R^2 - r^2) - (R - delta).  The force is
//     F(x) = k int (h + a sin(q (x + xi)))+ dA.
// dF/da at a = 0 is k times the integral of the sine over the disc of contact r < rho, rho^2 = 2 R delta -
// delta^2: that the disc's border moves with a costs a^2 only, as h vanishes there, and those terms have
// frequencies 0 and 2 q.  By symmetry in xi only the even part is left, and with the integral of
// exp(i q xi) over a disc,
//     F1 = k a int_disc cos(q xi) dA = k a 2 pi rho J1(q rho)/q.
// The next term at frequency q is of order a^3: a quadrature of the whole law gives 1 - 0.19 (a/delta)^2,
// 3e-4 here.
//
// Coupling.  The tool (mass m) hangs on the handle by the coupling (stiffness c, damping b), and the contact
// answers its vertical motion zeta by the stiffness K = k pi rho^2 of the wetted disc.  With w = q v,
//     m zeta'' + b zeta' + (c + K) zeta = F1 cos(w t),   force on the hand  c zeta + b zeta',
// so the amplitude on the device is
//     F1 |c + i w b| / |c + K - m w^2 + i w b|.
// Along x the contact has no force (normals along z), so the tool follows at the handle's speed.
//
// On the tetrahedra's own flat surface the same path gives a force of no such frequency.

namespace palpate::validation {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kRadius = 0.01, kDelta = 5e-4, kAmplitude = 2e-5, kWavelength = 8e-3;
constexpr double kStiffness = 1e8, kSpeed = 0.08, kMass = 0.05, kCoupling = 2000.0, kDamping = 10.0;
constexpr double kSettle = 0.1;  // [s]; e^(-b t/2m) = 5e-5
constexpr int kPeriods = 2;
const Vec3 kBlock(0.056, 0.024, 0.008);  // its top is z = 0

const double kWaveNumber = 2.0 * kPi / kWavelength;
const double kFrequency = kSpeed / kWavelength;  // [Hz]
const double kDisc = std::sqrt(2.0 * kRadius * kDelta - kDelta * kDelta);

/// A folder that goes with its owner.
class Folder {
 public:
  Folder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "palpate-validation-XXXXXX").string();
    if (!::mkdtemp(pattern.data())) fail("no folder can be made from {}", pattern);
    path_ = pattern;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::string file(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

/// Coarse tetrahedra, 8 mm wide, under a skin with 32 vertices a wavelength.
void write_block(const std::string& path, const std::string& fault) {
  store::ModelFile file;
  LayeredModel& model = file.model;
  model.name = "corrugated";
  model.tets = mesh::box(kBlock, {7, 3, 1});
  model.skin = mesh::box_surface(kBlock, {224, 24, 1});
  for (auto x : model.skin.vertices.colwise())
    if (x.z() > 0.0) x.z() += kAmplitude * std::sin(kWaveNumber * x.x());
  model.embedding = mesh::embed(model.tets, model.skin.vertices);
  if (fault == "no-rest-offset")  // a vertex outside its tetrahedron is put on it
    for (auto w : model.embedding.weights.colwise()) {
      w = w.cwiseMax(0.0).eval();
      w /= w.sum();
    }
  store::write_model(path, file);
}

scene::Description drag(contact::DepthBackend backend, const std::string& model, bool skin,
                        const std::string& fault) {
  scene::Description d;
  d.name = "felt-detail";
  d.duration_s = kSettle + kPeriods / kFrequency;
  SoftBodySpec block;
  block.name = "block";
  block.mesh.file = model;
  block.skin = skin;
  block.position_m = Vec3(0, 0, -0.5 * kBlock.z());
  AttachmentSpec all;  // the block is rigid: its tissue is another case's matter
  all.box_min_m = Vec3::Constant(-1.0);
  all.box_max_m = Vec3::Constant(1.0);
  block.attachments = {all};
  d.bodies = {block};
  ContactSpec contact;
  contact.first = "block";
  contact.second = "tool";
  contact.method = contact::backend_name(backend);
  contact.stiffness_pa_m = kStiffness;
  contact.pixels = 96;
  contact.quadrature_error = 0.0;
  contact.candidate_gap_m = 5e-5;
  d.contacts = {contact};
  const double force = kStiffness * kPi * kDelta * kDelta * (3.0 * kRadius - kDelta) / 3.0;
  d.tool.emplace();
  d.tool->shape = "mesh";
  d.tool->mesh.generator = "ball";
  d.tool->mesh.radius_m = kRadius;
  d.tool->mesh.element_size_m = 4e-4;
  d.tool->mass_kg = kMass;
  d.tool->inertia_kg_m2 = Vec3::Constant(0.4 * kMass * kRadius * kRadius);
  d.tool->position_m = Vec3(-0.5 * d.duration_s * kSpeed, 0.0, kRadius - kDelta);
  d.tool->coupling.stiffness_n_m = kCoupling;
  d.tool->coupling.damping_n_s_m = kDamping;
  d.device.emplace();
  d.device->max_force_n = 1e3;  // the limit is not what is measured
  KeyframeSpec start, end;
  start.position_m = d.tool->position_m - Vec3(0, 0, force / kCoupling);
  end = start;
  end.time_s = d.duration_s;
  end.position_m.x() += d.duration_s * kSpeed;
  end.interpolation = "linear";
  d.device->keyframes = {start, end};
  d.exchange.linearisation = "frozen";
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = fault == "slow-query" ? 0.04 : 2e-3;
  d.integrator.name = "linearly-implicit-euler";
  d.integrator.step_s = d.exchange.exchange_period_s;
  return d;
}

/// Force of the device along z, tick by tick, as its part at the frequency q v over whole periods.
class DeviceForce final : public loop::Observer {
 public:
  void tick(const loop::TickRecord& tick) override {
    if (tick.time <= kSettle + 1e-9) return;
    sum_ += tick.device.force.z() * std::polar(1.0, -2.0 * kPi * kFrequency * tick.time);
    mean_ += tick.device.force.z();
    ++ticks_;
  }
  double amplitude() const { return ticks_ > 0 ? 2.0 * std::abs(sum_) / ticks_ : std::nan(""); }
  double mean() const { return mean_ / ticks_; }

 private:
  std::complex<double> sum_;
  double mean_ = 0.0;
  int ticks_ = 0;
};

DeviceForce felt(const scene::Description& description) {
  const auto world = loop::assemble(description);
  DeviceForce force;
  loop::RunOptions options;
  options.observers = {&force};
  const loop::RunResult result = loop::run(*world, options);
  if (!result.status.ok()) fail("felt detail: {}", result.status.message);
  return force;
}

std::vector<Measurement> run(const std::string& fault) {
  const Folder folder;
  const std::string model = folder.file("corrugated.h5");
  write_block(model, fault);
  const double w = 2.0 * kPi * kFrequency, wetted = kStiffness * kPi * kDisc * kDisc;
  const double on_tool =
      kStiffness * kAmplitude * 2.0 * kPi * kDisc * std::cyl_bessel_j(1.0, kWaveNumber * kDisc) / kWaveNumber;
  const double exact = on_tool * std::abs(std::complex(kCoupling, w * kDamping)) /
                       std::abs(std::complex(kCoupling + wetted - kMass * w * w, w * kDamping));
  std::vector<Measurement> out;
  for (const contact::DepthBackend backend : image_backends(fault)) {
    const std::string name(contact::backend_name(backend));
    const DeviceForce skin = felt(drag(backend, model, fault != "coarse-surface", fault)),
                      coarse = felt(drag(backend, model, false, fault));
    out.push_back({.quantity = name + ": amplitude of the device force at frequency q v, on the skin [N]",
                   .computed = skin.amplitude(),
                   .exact = exact,
                   .error = std::abs(skin.amplitude() / exact - 1.0),
                   .bar = 0.02,
                   .note = fmt::format("{:g} Hz, on a mean force of {:.3f} N", kFrequency, skin.mean())});
    out.push_back(
        {.quantity =
             name + ": amplitude on the tetrahedra's own surface [N] (error: over the exact one on the skin)",
         .computed = coarse.amplitude(),
         .exact = 0.0,
         .error = coarse.amplitude() / exact,
         .bar = 0.02,
         .note = fmt::format("on a mean force of {:.3f} N", coarse.mean())});
  }
  say_what_is_skipped(out);
  return out;
}

}  // namespace

ValidationCase felt_detail() {
  return {.name = "felt-detail",
          .section = "B",
          .summary = "a tool dragged over a corrugated skin: the device force at the corrugation's frequency",
          .why =
              "the hand feels detail that only the skin has, at the right strength, through image, law, "
              "exchange and coupling; nothing of it comes from the coarse levels (volume law over the disc "
              "of contact: a Bessel function)",
          .quick = true,
          .run = run,
          .faults = {{"coarse-surface", "on the skin [N]"},
                     {"no-rest-offset", "at frequency q v"},
                     {"slow-query", "at frequency q v"}}};
}

}  // namespace palpate::validation
