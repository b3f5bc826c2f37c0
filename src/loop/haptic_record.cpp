#include "loop/haptic_record.h"

#include <filesystem>

#include "palpate/core/error.h"
#include "palpate/scene/hands.h"
#include "store/table_file.h"
#include "tool_instance.h"

namespace palpate::loop {
namespace {

// The lists of values of a tick and of an exchange are written once, and used for names, writing and reading.
template <class F, class P>
void visit_pose(F& f, const std::string& who, P& pose) {
  f(who + "_qw", pose.rotation.w());
  f(who + "_qx", pose.rotation.x());
  f(who + "_qy", pose.rotation.y());
  f(who + "_qz", pose.rotation.z());
  for (int i = 0; i < 3; ++i) f(who + "_" + "xyz"[i] + "_m", pose.translation[i]);
}

template <class F, class V>
void visit_pair(F& f, const std::string& first, V& a, const char* unit_a, const std::string& second, V& b,
                const char* unit_b) {
  for (int i = 0; i < 3; ++i) f(first + "_" + "xyz"[i] + unit_a, a[i]);
  for (int i = 0; i < 3; ++i) f(second + "_" + "xyz"[i] + unit_b, b[i]);
}

/// Visits the values of a tick.
/// @param Tick  TickRecord, const or not  @param f  f(name, double or integer of at most 53 bits)
template <class F, class Tick>
void visit_tick(F&& f, Tick& t) {
  f("time_s", t.time);
  f("length_s", t.length);
  f("record_version", t.record_version);
  f("handle_valid", t.handle_valid);
  f("switches", t.switches);
  f("limited", t.limited);
  f("ramps_in", t.ramps_in);
  f("left_out_ticks", t.left_out);
  visit_pose(f, "handle", t.handle);
  visit_pair(f, "handle_angular", t.handle_twist.angular, "_rad_s", "handle_linear", t.handle_twist.linear,
             "_m_s");
  visit_pose(f, "tool", t.tool);
  visit_pair(f, "tool_angular", t.tool_twist.angular, "_rad_s", "tool_linear", t.tool_twist.linear, "_m_s");
  visit_pair(f, "contact_torque", t.contact.moment, "_n_m", "contact_force", t.contact.force, "_n");
  visit_pair(f, "wanted_torque", t.requested.moment, "_n_m", "wanted_force", t.requested.force, "_n");
  visit_pair(f, "device_torque", t.device.moment, "_n_m", "device_force", t.device.force, "_n");
  visit_pair(f, "motors_torque", t.motors.moment, "_n_m", "motors_force", t.motors.force, "_n");
}

/// State of the handle before the first tick, as a TickRecord, and data of the whole run.
struct StartRow {
  TickRecord tick;
  device::PassivityController::Mode passivity = device::PassivityController::Mode::kOff;
};

template <class F, class Row>
void visit_start(F&& f, Row& r) {
  visit_tick(f, r.tick);
  f("passivity", r.passivity);
}

template <class F, class Record>
void visit_exchange(F&& f, Record& r) {
  const auto all = [&f](const std::string& name, auto& values) { visit_all(f, name, values); };
  f("version", r.version);
  f("time_s", r.time);
  f("source", r.source);
  f("samples", r.samples);
  all("x0", r.x0);
  all("v0", r.v0);
  all("f0", r.F0);
  all("f1", r.F1);
  all("j", r.J);
  all("b", r.B);
}

template <class F, class V>
void visit_all(F& f, const std::string& name, V& values) {
  for (std::size_t i = 0; i < values.size(); ++i) f(name + "_" + std::to_string(i), values[i]);
}

/// Visits the values of a model, except its points.
/// @param Row  ModelRow, const or not
template <class F, class Row>
void visit_model(F&& f, Row& r) {
  f("version", r.version);
  auto& model = r.model;
  f("time_s", model.time);
  f("points", model.points);
  f("modes", model.modes);
  f("samples", model.samples);
  visit_all(f, "tool", model.tool);
  visit_all(f, "missing_load", model.missing_load);
  visit_all(f, "missing_wrench", model.missing_wrench);
  visit_all(f, "stiffness", model.stiffness);
  visit_all(f, "damping", model.damping);
  visit_all(f, "force", model.force);
  visit_all(f, "force_rate", model.force_rate);
}

template <class F, class Row>
void visit_point(F&& f, Row& r) {
  f("version", r.version);
  auto& point = r.point;
  f("pair", point.pair);
  f("area_m2", point.area);
  f("held_stiffness_n_m", point.held_stiffness);
  f("held_damping_n_s_m", point.held_damping);
  visit_all(f, "offset_m", point.offset);
  visit_all(f, "slide_m", point.slide);
  visit_all(f, "normal", point.normal);
  visit_all(f, "place_m", point.place);
  visit_all(f, "velocity_m_s", point.velocity);
  visit_all(f, "deflection_m", point.deflection);
  visit_all(f, "mode", point.modes);
}

/// Rows of the tables of models; the version identifies the exchange.
struct ModelRow {
  std::uint64_t version = 0;
  contact::ReducedContactModel model;  ///< Its points are separate rows.
};
struct PointRow {
  std::uint64_t version = 0;
  contact::ReducedContactModel::Point point;
};

template <class Visit, class Record>
std::vector<std::string> names_of(Visit visit, Record record) {
  std::vector<std::string> out;
  visit([&](const std::string& name, const auto&) { out.push_back(name); }, record);
  return out;
}

const auto kVisitTick = [](auto&& f, auto& t) { visit_tick(f, t); };
const auto kVisitStart = [](auto&& f, auto& r) { visit_start(f, r); };
const auto kVisitExchange = [](auto&& f, auto& r) { visit_exchange(f, r); };
const auto kVisitModel = [](auto&& f, auto& r) { visit_model(f, r); };
const auto kVisitPoint = [](auto&& f, auto& r) { visit_point(f, r); };

template <class Visit, class Record>
void flatten(Visit visit, const Record& record, std::vector<double>& row) {
  row.clear();
  visit([&](const std::string&, const auto& value) { row.push_back(static_cast<double>(value)); }, record);
}

template <class Visit, class Record>
std::vector<Record> read(Visit visit, Record empty, const std::string& path, const std::string& name) {
  const store::Table table = store::read_table(path, name);
  if (table.columns != names_of(visit, empty))
    fail("{}: the columns of {} differ from those of this version of palpate; record the run again", path,
         name);
  std::vector<Record> out(table.rows(), empty);
  for (std::size_t i = 0; i < out.size(); ++i) {
    auto at = table.row(i).begin();
    visit([&]<class T>(const std::string&, T& value) { value = static_cast<T>(*at++); }, out[i]);
  }
  return out;
}

enum Tables : std::size_t { kStart, kTicks, kExchanges, kModels, kPoints };

/// Reads the models, one per exchange; empty if no exchange has points.
std::vector<contact::ReducedContactModel> read_models(const std::string& path, std::size_t exchanges) {
  std::vector<contact::ReducedContactModel> out;
  const std::vector<ModelRow> models = read(kVisitModel, ModelRow{}, path, "models");
  if (models.empty()) return out;
  out.resize(exchanges);
  const auto model_of = [&](std::uint64_t version) -> contact::ReducedContactModel& {
    if (version == 0 || version > exchanges)
      fail("{}: a contact model refers to exchange {}, which was not recorded", path, version);
    return out[version - 1];
  };
  for (const ModelRow& row : models) {
    contact::ReducedContactModel& model = model_of(row.version);
    model = row.model;
    model.points = 0;
  }
  for (const PointRow& row : read(kVisitPoint, PointRow{}, path, "points")) {
    contact::ReducedContactModel& model = model_of(row.version);
    if (model.points == contact::ReducedContactModel::kMostPoints)
      fail("{}: exchange {} has more contact points than this version of palpate supports", path,
           row.version);
    model.point[static_cast<std::size_t>(model.points++)] = row.point;
  }
  return out;
}

}  // namespace

struct HapticRecorder::Impl {
  Impl(const std::string& path, std::size_t whose) : hand(whose), file(path, tables()) {}
  Impl(const std::string& path, std::size_t whose, const store::TableFile::Journal& from)
      : hand(whose), file(path, tables(), from) {}
  static std::vector<store::TableSpec> tables() {
    return {{"start", names_of(kVisitStart, StartRow{})},
            {"ticks", names_of(kVisitTick, TickRecord{})},
            {"exchanges", names_of(kVisitExchange, dynamics::LinearisedContact{})},
            {"models", names_of(kVisitModel, ModelRow{})},
            {"points", names_of(kVisitPoint, PointRow{})}};
  }
  std::size_t hand;
  store::TableFile file;
  std::vector<double> row;
};

HapticRecorder::HapticRecorder(const std::string& path, std::size_t hand)
    : impl_(std::make_unique<Impl>(path, hand)) {}
HapticRecorder::HapticRecorder(const std::string& path, std::size_t hand,
                               const store::TableFile::Journal& from)
    : impl_(std::make_unique<Impl>(path, hand, from)) {}
HapticRecorder::~HapticRecorder() = default;

store::TableFile::Journal HapticRecorder::place() { return impl_->file.place(); }

void HapticRecorder::period(World& world, double t) {
  if (t == 0.0) {
    const ToolInstance& tool = world.tools.at(impl_->hand);
    StartRow start;
    start.tick.handle = tool.handle.pose;
    start.tick.handle_twist = tool.handle.twist;
    start.tick.handle_valid = tool.handle.valid;
    start.tick.switches = tool.handle.switches;
    if (tool.passivity) start.passivity = tool.passivity->mode();
    flatten(kVisitStart, start, impl_->row);
    impl_->file.append(kStart, impl_->row);
  }
  impl_->file.flush();
}

void HapticRecorder::tick(const TickRecord& tick) {
  flatten(kVisitTick, tick, impl_->row);
  impl_->file.append(kTicks, impl_->row);
}

void HapticRecorder::exchanged(const ContactRecord& record) {
  flatten(kVisitExchange, record.linear, impl_->row);
  impl_->file.append(kExchanges, impl_->row);
  if (record.linear.source != dynamics::LinearisedContact::Source::kPoints) return;
  const std::uint64_t version = record.linear.version;
  flatten(kVisitModel, ModelRow{version, record.touch}, impl_->row);
  impl_->file.append(kModels, impl_->row);
  for (int i = 0; i < record.touch.points; ++i) {
    flatten(kVisitPoint, PointRow{version, record.touch.point[static_cast<std::size_t>(i)]}, impl_->row);
    impl_->file.append(kPoints, impl_->row);
  }
}

HapticRecord read_haptic_record(const std::string& path) {
  if (!std::filesystem::exists(path))
    fail("{}: no such file; a run with a tool writes it if the scene has [record], or with --realtime", path);
  HapticRecord out;
  const std::vector<StartRow> start = read(kVisitStart, StartRow{}, path, "start");
  if (start.size() != 1) fail("{}: the record has no start; the run ended before its first tick", path);
  out.start = start.front().tick;
  out.passivity = start.front().passivity;
  out.ticks = read(kVisitTick, TickRecord{}, path, "ticks");
  out.exchanges = read(kVisitExchange, dynamics::LinearisedContact{}, path, "exchanges");
  out.models = read_models(path, out.exchanges.size());
  return out;
}

std::vector<std::string> haptic_files(const scene::Description& description) {
  std::vector<std::string> out;
  for (const scene::Hand& hand : scene::hands_of(description))
    out.push_back(out.empty() ? "haptic.h5" : fmt::format("haptic-{}.h5", hand.name));
  return out;
}

std::vector<HapticRecord> read_haptic_records(const std::string& folder,
                                              const scene::Description& description) {
  std::vector<HapticRecord> out;
  for (const std::string& name : haptic_files(description))
    out.push_back(read_haptic_record((std::filesystem::path(folder) / name).string()));
  return out;
}

}  // namespace palpate::loop
