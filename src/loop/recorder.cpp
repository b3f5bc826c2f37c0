#include "palpate/loop/recorder.h"

#include <cmath>
#include <filesystem>

#include "loop/contact_record.h"
#include "loop/haptic_record.h"
#include "palpate/core/error.h"
#include "palpate/scene/hands.h"
#include "palpate/store/run_file.h"
#include "store/atomic_file.h"
#include "store/bone_file.h"
#include "store/force_file.h"
#include "store/provenance.h"

namespace palpate::loop {
namespace {

constexpr const char* kRunFile = "run.vtkhdf";
constexpr const char* kForceFile = "force.csv";
constexpr const char* kBoneFile = "bones.csv";
constexpr const char* kEnergyFile = "energy.csv";

std::vector<std::string> energy_headers() {
  std::vector<std::string> headers = {"time_s"};
  const EnergyBalance none;
  visit_energies([&](const char* name, double) { headers.emplace_back(name); }, none);
  return headers;
}

/// Returns the number of loop periods between two recorded states.
int periods_between(const scene::Description& d) {
  return std::max(1, static_cast<int>(std::lround(d.record->state_period_s / period_of(d))));
}

}  // namespace

/// Positions in the files of a run at a checkpoint.
struct Places {
  store::RunFile::Place states;
  std::vector<store::CsvWriter::Place> forces;
  std::vector<store::TableFile::Journal> haptic;
  store::CsvWriter::Place bones, energy;
};

struct Recorder::Impl {
  std::string folder;
  bool resumable = false, has_bones = false;
  double duration_s = 0.0;
  scene::Description description;
  std::vector<store::RunPart> parts;  ///< Parts of the state file, until it is opened.
  store::RunInfo info;
  std::unique_ptr<store::RunFile> states;
  std::vector<std::unique_ptr<store::ForceFile>> forces;  ///< Per hand.
  std::vector<std::unique_ptr<HapticRecorder>> haptic;    ///< Per hand.
  std::unique_ptr<store::BoneFile> bones;
  std::unique_ptr<store::CsvWriter> energy;
  std::vector<TriMesh> tools;  ///< Per hand, in the tool's axes.
  int every = 1;               ///< Periods between two recorded states.
  long seen = 0;               ///< Periods so far.
  std::vector<std::pair<Pose, Twist>> tool_motions;
  Points points, velocity;
  VecX stress;

  /// Defines the parts of the state file from the World at the start.
  void take_parts(const World& world) {
    Eigen::Index count = 0;
    for (const Body& body : world.bodies) {
      parts.push_back({body.name, body.placed, body.file_tets(), {}});
      parts.back().reference(Eigen::all, body.file_node) = body.placed;
      count += body.placed.cols();
    }
    const scene::Description& d = world.description;
    for (const Bone& bone : world.bones) {
      if (bone.surface.vertices.cols() == 0) continue;
      parts.push_back({bone.name, placed(bone.surface, world.bone_pose(bone)), {}, bone.surface.faces});
      count += bone.surface.vertices.cols();
    }
    for (const scene::Hand& hand : scene::hands_of(d)) {
      const TriMesh& tool = tools.emplace_back(tool_surface(*hand.tool, world.folder));
      const Pose pose{quaternion_of(hand.tool->rotation_vector_rad), hand.tool->position_m};
      tool_motions.emplace_back(pose, Twist{});
      parts.push_back({hand.name, placed(tool, pose), {}, tool.faces});
      count += tool.vertices.cols();
    }
    const int steps = static_cast<int>(duration_s / (every * period_of(d))) + 2;
    info = {d.name, d.source, store::provenance().version, steps};
    points.resize(3, count);
    velocity.resize(3, count);
    stress.setZero(count);
  }

  std::string path(const std::string& name) const { return (std::filesystem::path(folder) / name).string(); }
  void open(const Places* from);
  Places places();

  static Points placed(const TriMesh& surface, const Pose& pose) {
    Points out = pose.rotation.toRotationMatrix() * surface.vertices;
    out.colwise() += pose.translation;
    return out;
  }

  /// Writes a rigid surface at its pose, from point `first` on; returns the index behind it.
  Eigen::Index place(const TriMesh& surface, const Pose& pose, const Twist& twist, Eigen::Index first) {
    const Eigen::Index n = surface.vertices.cols();
    points.middleCols(first, n) = placed(surface, pose);
    for (Eigen::Index i = first; i < first + n; ++i)
      velocity.col(i) = twist.at(points.col(i) - pose.translation);
    return first + n;
  }

  void append(World& world, double t) {
    const dynamics::StateView view = world.state.view();
    Eigen::Index first = 0;
    for (const Body& body : world.bodies) {
      const dynamics::Block& block = *view.layout->find(body.block_id);
      const Eigen::Index n = body.placed.cols();
      points.middleCols(first, n)(Eigen::all, body.file_node) =
          Eigen::Map<const Points>(view.q.data() + block.q_offset, 3, n);
      velocity.middleCols(first, n)(Eigen::all, body.file_node) =
          Eigen::Map<const Points>(view.u.data() + block.u_offset, 3, n);
      stress.segment(first, n)(body.file_node) = body.nodal_stress(view);
      first += n;
    }
    for (const Bone& bone : world.bones)
      first = place(bone.surface, world.bone_pose(bone), world.bone_twist(bone), first);
    for (std::size_t i = 0; i < tools.size(); ++i)
      first = place(tools[i], tool_motions[i].first, tool_motions[i].second, first);
    states->append(t, points, velocity, stress);
  }

  void append_bones(World& world, double t) {
    const std::vector<Wrench> wrenches = world.wrenches_on_bones();
    for (std::size_t i = 0; i < wrenches.size(); ++i)
      bones->append({t, static_cast<int>(i), world.bone_pose(world.bones[i]),
                     world.bone_twist(world.bones[i]), wrenches[i]});
    bones->flush();
  }
};

/// Brings all recorded data to disk and returns the positions: no checkpoint is ahead of the files.
Places Recorder::Impl::places() {
  Places at;
  const auto safe = [&](const std::string& name) { store::sync_file(path(name)); };
  if (states) at.states = states->place(), safe(kRunFile);
  if (bones) at.bones = bones->place(), safe(kBoneFile);
  if (energy) at.energy = energy->place(), safe(kEnergyFile);
  const std::vector<std::string> names = haptic_files(description);
  for (std::size_t i = 0; i < haptic.size(); ++i) {
    at.haptic.push_back(haptic[i]->place());
    safe(store::TableFile::journal_path(names[i]));
  }
  for (const auto& one : forces) at.forces.push_back(one->place()), store::sync_file(one->path());
  return at;
}

/// Opens the files.  @param from  positions at which files are continued; null: new files
void Recorder::Impl::open(const Places* from) {
  const scene::Description& d = description;
  if (!parts.empty())
    states = std::make_unique<store::RunFile>(
        from ? store::RunFile::continued(path(kRunFile), parts, info, from->states)
             : store::RunFile(path(kRunFile), parts, info));
  parts.clear();
  const auto open_csv = [&]<class File>(const std::string& name, const store::CsvWriter::Place* place) {
    return place ? File(path(name), *place) : File(path(name));
  };
  if (has_bones)
    bones = std::make_unique<store::BoneFile>(
        open_csv.operator()<store::BoneFile>(kBoneFile, from ? &from->bones : nullptr));
  if (d.record->energy)
    energy = from ? std::make_unique<store::CsvWriter>(path(kEnergyFile), energy_headers(), from->energy)
                  : std::make_unique<store::CsvWriter>(path(kEnergyFile), energy_headers());
  if (!d.record->forces || !d.tool) return;
  for (const std::string& name : haptic_files(d)) {
    const std::size_t i = haptic.size();
    haptic.push_back(resumable ? std::make_unique<HapticRecorder>(
                                     path(name), i, from ? from->haptic.at(i) : store::TableFile::Journal{})
                               : std::make_unique<HapticRecorder>(path(name), i));
  }
  for (const scene::Hand& hand : scene::hands_of(d)) {
    const std::size_t i = forces.size();
    const std::string name = i == 0 ? kForceFile : fmt::format("force-{}.csv", hand.name);
    forces.push_back(std::make_unique<store::ForceFile>(
        open_csv.operator()<store::ForceFile>(name, from ? &from->forces.at(i) : nullptr)));
  }
}

Recorder::Recorder(const World& world, const std::string& folder)
    : Recorder(world, folder, false, 0.0, false) {}
Recorder::Recorder(const World& world, const std::string& folder, bool goes_on, double duration_s)
    : Recorder(world, folder, goes_on, duration_s, true) {}

Recorder::Recorder(const World& world, const std::string& folder, bool goes_on, double duration_s,
                   bool resumable)
    : impl_(std::make_unique<Impl>()) {
  Impl& m = *impl_;
  m.folder = folder;
  m.resumable = resumable;
  m.description = world.description;
  const scene::Description& d = m.description;
  if (!d.record) return;
  m.duration_s = duration_s > 0.0 ? duration_s : d.duration_s;
  m.every = periods_between(d);
  m.has_bones = d.record->states && !world.bones.empty();
  if (d.record->states && !world.bodies.empty()) m.take_parts(world);
  if (goes_on) return;  // archive() opens the files
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed) fail("{}: cannot create the results folder: {}", folder, failed.message());
  m.open(nullptr);
}

void Recorder::archive(Archive& a) {
  Impl& m = *impl_;
  PALPATE_CHECK(m.resumable, "this recorder belongs to a run without checkpoints and cannot be archived");
  a("seen", m.seen);
  if (!m.description.record) return;
  Places at;
  if (!a.is_restoring()) at = m.places();
  a("states", at.states.steps);
  a("states_content", at.states.content);
  a.list("forces", at.forces, [&](store::CsvWriter::Place& place) { place.archive(a); });
  a.list("haptic", at.haptic, [&](store::TableFile::Journal& journal) {
    a("bytes", journal.bytes);
    a("content", journal.content);
  });
  a("bones", at.bones);
  a("energy", at.energy);
  if (a.is_restoring()) m.open(&at);
}

Recorder::~Recorder() = default;

void Recorder::close() {
  for (const auto& forces : impl_->forces) forces->flush();
  if (impl_->bones) impl_->bones->flush();
  if (impl_->energy) impl_->energy->flush();
  if (impl_->states) impl_->states->close();
}

void Recorder::period(World& world, double t) {
  for (std::size_t i = 0; i < impl_->tool_motions.size(); ++i)
    impl_->tool_motions[i] = {world.tool_pose(i), world.tool_twist(i)};
  if (impl_->states && impl_->seen % impl_->every == 0) impl_->append(world, t);
  if (impl_->bones && impl_->seen % impl_->every == 0) impl_->append_bones(world, t);
  for (const auto& forces : impl_->forces) forces->flush();
  for (const auto& haptic : impl_->haptic) haptic->period(world, t);
  ++impl_->seen;
}

bool Recorder::wants_energy() const { return impl_->energy != nullptr; }

void Recorder::energy(const EnergyBalance& balance) {
  if (!impl_->energy) return;
  std::vector<double> row = {balance.time};
  visit_energies([&](const char*, double value) { row.push_back(value); }, balance);
  impl_->energy->row(row);
  impl_->energy->flush();
}

void Recorder::exchanged_of(std::size_t hand, const ContactRecord& record) {
  if (hand < impl_->haptic.size()) impl_->haptic[hand]->exchanged(record);
}

void Recorder::tick_of(std::size_t hand, const TickRecord& tick) {
  if (hand >= impl_->forces.size()) return;
  impl_->haptic[hand]->tick(tick);
  impl_->forces[hand]->append({tick.time, tick.handle, tick.tool, tick.device, tick.limited, tick.switches});
}

}  // namespace palpate::loop
