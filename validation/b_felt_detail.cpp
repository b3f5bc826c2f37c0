#include <unistd.h>

#include <cmath>
#include <complex>
#include <filesystem>

#include "b_free_tool.h"
#include "cases.h"
#include "palpate/core/error.h"
#include "palpate/loop/run.h"
#include "palpate/mesh/generators.h"
#include "store/model_file.h"

// Problem: a round tool with radius R is dragged at speed v over a block of few tetrahedra whose skin is
// corrugated, z = a sin(q x). The surface of the tetrahedra is flat: only the skin carries the corrugation.
//
// Exact answer, contact law. Contact is by the points of both skins, each side with half of its weight
// (SphereOnSkin, b_free_tool.h). A small height eta(x) of the corrugation changes the depths and so, with the
// tool's lowest point delta below the mean surface and c = R - delta, the force to first order by
//     k int eta w dA over the disc of contact,  w the mean of both sides:
//     sphere   the depth of a point of the sphere grows by eta; per area of the plane
//              dA_s = R/sqrt(R^2 - r^2) dA:
//              w_s = R/sqrt(R^2 - r^2)
//     plane    the depth R - rho of a point of the plane, rho^2 = r^2 + c^2, grows by eta c/rho, the energy
//              by k (R - rho) c/rho eta, the force by its derivative with respect to delta:
//              w_p = -d/dc (R c/rho - c) = 1 - R/rho + R c^2/rho^3.
// The border of the disc also moves with eta; as the depth vanishes there, the effect is only eta^2. The even
// part of eta = a sin(q x) remains, and with J0 the mean of cos(q x) over a circle the force has the
// amplitude
//     F1 = k a 2 pi int_0^rho J0(q r) (w_s + w_p)/2 r dr.
//
// Exact answer, coupling. The tool (mass m) is connected to the handle by the coupling (stiffness c, damping
// b), and the contact opposes its vertical motion zeta with the stiffness K = k V'(delta). With w = q v,
//     m zeta'' + b zeta' + (c + K) zeta = F1 cos(w t),   force on the hand  c zeta + b zeta',
// so the amplitude at the device is
//     F1 |c + i w b| / |c + K - m w^2 + i w b|.
// Along x the contact has no force (normals along z), so the tool follows at the speed of the handle.
//
// Measured: the amplitude of the device force at frequency q v on the skin, against this value, limit 2 %. On
// the flat surface of the tetrahedra the same path must give no force at this frequency: at most 0.02 of the
// exact one.

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

/// Temporary folder, removed with its owner.
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

/// Writes the block: coarse tetrahedra, 8 mm wide, under a skin with 32 vertices per wavelength.
void write_block(const std::string& path, const std::string& fault) {
  store::ModelFile file;
  LayeredModel& model = file.model;
  model.name = "corrugated";
  model.tets = mesh::box(kBlock, {7, 3, 1});
  model.skin = mesh::box_surface(kBlock, {224, 24, 1});
  for (auto x : model.skin.vertices.colwise())
    if (x.z() > 0.0) x.z() += kAmplitude * std::sin(kWaveNumber * x.x());
  model.embedding = mesh::embed(model.tets, model.skin.vertices);
  if (fault == "no-rest-offset")  // A vertex outside its tetrahedron is moved onto it.
    for (auto w : model.embedding.weights.colwise()) {
      w = w.cwiseMax(0.0).eval();
      w /= w.sum();
    }
  store::write_model(path, file);
}

scene::Description drag(const std::string& model, bool skin, const std::string& fault) {
  scene::Description d;
  d.name = "felt-detail";
  d.duration_s = kSettle + kPeriods / kFrequency;
  SoftBodySpec block;
  block.name = "block";
  block.mesh.file = model;
  block.skin = skin;
  block.position_m = Vec3(0, 0, -0.5 * kBlock.z());
  AttachmentSpec all;  // The block is rigid: deformation is covered by other cases.
  all.box_min_m = Vec3::Constant(-1.0);
  all.box_max_m = Vec3::Constant(1.0);
  block.attachments = {all};
  d.bodies = {block};
  ContactSpec contact;
  contact.first = "block";
  contact.second = "tool";
  contact.method = "distance";
  contact.quadrature_error = 1e-4;
  contact.stiffness_pa_m = kStiffness;
  contact.candidate_gap_m = 5e-5;
  d.contacts = {contact};
  const double force = kStiffness * SphereOnSkin{kRadius}.force(kDelta);
  d.tool.emplace();
  d.tool->shape = ToolShape::kMesh;
  d.tool->mesh.generator = "ball";
  d.tool->mesh.radius_m = kRadius;
  d.tool->mesh.element_size_m = 4e-4;
  d.tool->mass_kg = kMass;
  d.tool->inertia_kg_m2 = Vec3::Constant(0.4 * kMass * kRadius * kRadius);
  d.tool->position_m = Vec3(-0.5 * d.duration_s * kSpeed, 0.0, kRadius - kDelta);
  d.tool->coupling.stiffness_n_m = kCoupling;
  d.tool->coupling.damping_n_s_m = kDamping;
  d.device.emplace();
  d.device->max_force_n = 1e3;  // The force limit is not measured.
  KeyframeSpec start, end;
  start.position_m = d.tool->position_m - Vec3(0, 0, force / kCoupling);
  end = start;
  end.time_s = d.duration_s;
  end.position_m.x() += d.duration_s * kSpeed;
  end.interpolation = Interpolation::kLinear;
  d.device->keyframes = {start, end};
  d.exchange.linearisation = "frozen";
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = fault == "slow-query" ? 0.04 : 2e-3;
  d.integrator.name = "linearly-implicit-euler";
  d.integrator.step_s = d.exchange.exchange_period_s;
  return d;
}

/// Component of the device force along z at the frequency q v, accumulated tick by tick over whole periods.
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

/// Returns int_0^rho J0(q r) (w_s + w_p)/2 r dr by Simpson's rule [m^2].
double weighted_disc() {
  constexpr int kParts = 2000;
  const double c = kRadius - kDelta;
  const auto at = [&](double r) {
    const double rho = std::sqrt(r * r + c * c);
    return std::cyl_bessel_j(0.0, kWaveNumber * r) * r * 0.5 *
           (kRadius / std::sqrt(kRadius * kRadius - r * r) + 1.0 - kRadius / rho +
            kRadius * c * c / (rho * rho * rho));
  };
  double sum = at(0.0) + at(kDisc);
  for (int i = 1; i < kParts; ++i) sum += (i % 2 == 1 ? 4.0 : 2.0) * at(i * kDisc / kParts);
  return sum * kDisc / (3.0 * kParts);
}

std::vector<Measurement> run(const std::string& fault) {
  const Folder folder;
  const std::string model = folder.file("corrugated.h5");
  write_block(model, fault);
  const double w = 2.0 * kPi * kFrequency, wetted = kStiffness * SphereOnSkin{kRadius}.stiffness(kDelta);
  const double on_tool = kStiffness * kAmplitude * 2.0 * kPi * weighted_disc();
  const double exact = on_tool * std::abs(std::complex(kCoupling, w * kDamping)) /
                       std::abs(std::complex(kCoupling + wetted - kMass * w * w, w * kDamping));
  std::vector<Measurement> out;
  {
    const DeviceForce skin = felt(drag(model, fault != "coarse-surface", fault)),
                      coarse = felt(drag(model, false, fault));
    out.push_back({.quantity = "amplitude of the device force at frequency q v, on the skin [N]",
                   .computed = skin.amplitude(),
                   .exact = exact,
                   .error = std::abs(skin.amplitude() / exact - 1.0),
                   .bar = 0.02,
                   .note = fmt::format("{:g} Hz, on a mean force of {:.3f} N", kFrequency, skin.mean())});
    out.push_back({.quantity =
                       "amplitude on the surface of the tetrahedra [N] (error: relative to the exact one on "
                       "the skin)",
                   .computed = coarse.amplitude(),
                   .exact = 0.0,
                   .error = coarse.amplitude() / exact,
                   .bar = 0.02,
                   .note = fmt::format("on a mean force of {:.3f} N", coarse.mean())});
  }
  return out;
}

}  // namespace

ValidationCase felt_detail() {
  return {.name = "felt-detail",
          .section = "B",
          .summary = "a tool dragged over a corrugated skin: the device force at the corrugation's frequency",
          .why =
              "detail that only the skin has reaches the hand with the correct amplitude through points, "
              "law, exchange and coupling, and the coarse levels contribute nothing to it (weight of the law "
              "over the disc of contact, with a Bessel function)",
          .quick = true,
          .run = run,
          .faults = {{"coarse-surface", "on the skin [N]"},
                     {"no-rest-offset", "at frequency q v"},
                     {"slow-query", "at frequency q v"}}};
}

}  // namespace palpate::validation
