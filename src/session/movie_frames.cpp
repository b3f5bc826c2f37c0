#include "session/movie_frames.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "core/missing_outputs.h"
#include "palpate/core/error.h"
#include "render/seen.h"
#include "session/scene_view.h"
#include "session/shade_values.h"
#include "session/snapshot_scene.h"

namespace palpate::session {
namespace {

constexpr int kWidth = 960, kHeight = 720, kStrip = 150;  ///< pixels

/// Extreme points of a set in each of 98 directions, at most 18 degrees from any direction: enough for a
/// camera to frame all points nearly as closely as from the full set.
class Extremes {
 public:
  void add(const Points& points) {
    if (points.cols() == 0) return;
    std::size_t i = 0;
    for (int x = -2; x <= 2; ++x)
      for (int y = -2; y <= 2; ++y)
        for (int z = -2; z <= 2; ++z) {
          if (x % 2 == 0 && y % 2 == 0 && z % 2 == 0) continue;  // zero or a duplicate direction
          Eigen::Index farthest = 0;
          const double reach = (Vec3(x, y, z).transpose() * points).maxCoeff(&farthest);
          Extreme& extreme = extremes_.at(i++);
          if (reach > extreme.reach) extreme = {reach, points.col(farthest)};
        }
  }
  Points points() const {
    Points out(3, std::ssize(extremes_));
    for (std::size_t i = 0; i < extremes_.size(); ++i)
      out.col(static_cast<Eigen::Index>(i)) = extremes_[i].point;
    return out;
  }

 private:
  struct Extreme {
    double reach = -INFINITY;
    Vec3 point = Vec3::Zero();
  };
  std::array<Extreme, 98> extremes_;
};

/// Properties that all frames share.
struct Common {
  render::ColourScale scale;
  Points frame;
  contact::View view;
  render::View from;
};

Common common_of(const loop::World& world, SnapshotSpool& snapshots, Shade shade, double largest) {
  Common out;
  const bool known = largest > 0.0;
  Extremes extremes;
  render::ViewChoice choice;
  constexpr int kLooked = 8;  // snapshots examined, evenly spaced
  const int between = std::max(1, snapshots.count() / kLooked);
  snapshots.rewind();
  int number = 0;
  for (WorldSnapshot snapshot; snapshots.next(snapshot); ++number) {
    const render::Scene scene = scene_of(world, snapshot, shade);
    if (number % between == between / 2) choice.add(scene);
    if (!known) largest = std::max(largest, largest_value(world, snapshot, shade));
    for (const render::Surface& surface : scene.surfaces) extremes.add(surface.points);
  }
  render::Scene all;
  all.surfaces.emplace_back().points = extremes.points();
  out.view = view_of(all);
  out.scale = colour_scale(world, shade, out.view.extent, largest);
  add_obstacles(all, world, out.view);
  for (const render::Surface& surface : all.surfaces) extremes.add(surface.points);
  out.frame = extremes.points();
  out.from = scene_view(world.description.view, choice.best(!all.ground));
  return out;
}

double whole_periods(const scene::Description& d, double wanted_s) {
  const double period = loop::period_of(d);
  return static_cast<double>(std::max(1L, std::lround(wanted_s / period))) * period;
}

/// Checks that the loop has enough periods for a frame rate.
/// @param per_s  frames per second of simulated time
/// @param asked  the option with its value, for the message
void check_rate(const scene::Description& d, double per_s, const std::string& asked) {
  const double period = loop::period_of(d);
  if (per_s * period <= 1.001) return;
  fail(
      "{}: the frame rate exceeds the loop rate of the scene, one state per {:g} s or {:g} per second of "
      "simulated time ({}); reduce the frame rate or shorten the period",
      asked, period, 1.0 / period,
      d.tool && !d.exchange.has_tools_in_state() ? "exchange.exchange_period_s"
      : !d.contacts.empty() || d.tool            ? "exchange.contact_refresh_s"
                                                 : "record.state_period_s, else all of duration_s");
}

/// Writes pictures to every working sink, and reports sinks that fail.
class Writer {
 public:
  Writer(const std::vector<FrameSink*>& sinks, MissingOutputs& missing) : sinks_(sinks), missing_(missing) {}
  bool idle() const { return sinks_.empty(); }
  void add(const render::Picture& picture) {
    each([&](FrameSink& sink) { sink.add(picture); });
  }
  void close() {
    each([](FrameSink& sink) { sink.close(); });
  }
  void give_up(const Error& why) {
    each([&](FrameSink&) { throw why; });
  }

 private:
  template <class Do>
  void each(Do what) {
    std::erase_if(sinks_, [&](FrameSink* sink) {
      try {
        what(*sink);
        return false;
      } catch (const Error& e) {
        missing_.add(sink->missing(), e.what());
        return true;
      }
    });
  }
  std::vector<FrameSink*> sinks_;
  MissingOutputs& missing_;
};

}  // namespace

double between_frames(const scene::Description& d, double per_s) {
  if (per_s > 0.0) check_rate(d, per_s, fmt::format("--frames-per-s {:g}", per_s));
  return whole_periods(d, per_s > 0.0 ? 1.0 / per_s : d.record ? d.record->state_period_s : 0.0);
}

double between_movie_frames(const scene::Description& d, double fps, double slow) {
  if (fps > 0.0) check_rate(d, fps * slow, fmt::format("--fps {:g} --slow {:g}", fps, slow));
  return whole_periods(d, 1.0 / ((fps > 0.0 ? fps : kMovieRate) * slow));
}

FrameSize frame_size(const std::string& text) {
  FrameSize out;
  const char* end = text.data() + text.size();
  const auto [cross, bad] = std::from_chars(text.data(), end, out.width);
  const bool first = bad == std::errc() && cross != end && *cross == 'x';
  const auto [stop, worse] = first ? std::from_chars(cross + 1, end, out.height) : std::from_chars_result{};
  if (!first || worse != std::errc() || stop != end)
    fail("--size {}: is not a size in pixels; write WIDTHxHEIGHT, for example 640x480", text);
  for (const int side : {out.width, out.height})
    if (side < 160 || side > 4096 || side % 2 != 0)
      fail("--size {}: each side must be an even number of pixels, 160 to 4096", text);
  return out;
}

MovieFrames::MovieFrames(const loop::World& world, const std::string& folder, Shade shade, double between_s,
                         double duration_s, FrameSize size)
    : shade_(shade),
      between_s_(between_s),
      end_s_(duration_s),
      width_(size.width > 0 ? size.width : kWidth),
      height_(size.height > 0 ? size.height : kHeight),
      snapshots_(folder) {
  if (world.description.tool)
    curve_ = {"force on the hand", "N", {}, {}};
  else if (world.contact)
    curve_ = {"contact force", "N", {}, {}};
  else
    return;
  strip_ = size.height > 0 ? size.height * kStrip / (kHeight + kStrip) : kStrip;
  if (size.height > 0) height_ -= strip_;
}

void MovieFrames::tick(const loop::TickRecord& tick) {
  curve_.times.push_back(tick.time);
  curve_.values.push_back(tick.device.force.norm());
  if (!tick.handle_valid) return;
  handle_ = tick.handle;
  if (!first_handle_) first_handle_ = tick.handle;
}

int MovieFrames::count() const {
  return std::max(next_, static_cast<int>(std::ceil(std::min(reached_, end_s_) / between_s_ - 1e-6)));
}

int MovieFrames::frame_at(double t) const { return static_cast<int>(std::floor(t / between_s_ + 1e-6)); }

void MovieFrames::reach(double t) {
  reached_ = t;
  due_ = frame_at(t) >= next_ && t < end_s_ * (1.0 - 1e-9);
}

void MovieFrames::period(loop::World& world, double t) {
  reach(t);
  if (due_ && shade_ != Shade::kPenetration) keep(snapshot_of(world, t, shade_));
}

void MovieFrames::show(WorldSnapshot snapshot) {
  reach(snapshot.time);
  if (due_) keep(std::move(snapshot));
}

void MovieFrames::queried(loop::World& world, double t) {
  if (!world.description.tool) {
    double force = 0.0;
    for (const contact::ContactPoint& p : world.contact->points(world.state.view()))
      force += p.pressure * p.area;
    curve_.times.push_back(t);
    curve_.values.push_back(force);
  }
  if (due_ && shade_ == Shade::kPenetration) keep(snapshot_of(world, t, shade_));
}

void MovieFrames::keep(WorldSnapshot snapshot) {
  snapshot.handle = handle_;
  snapshots_.append(snapshot);
  next_ = frame_at(snapshot.time) + 1;
  due_ = false;
}

void MovieFrames::save(const loop::World& world, const std::vector<FrameSink*>& sinks,
                       const Callbacks& callbacks, MissingOutputs& missing, double largest) {
  Writer writer(sinks, missing);
  try {
    if (snapshots_.count() == 0) fail("the run ended before the first frame");
    const Common common = common_of(world, snapshots_, shade_, largest);
    render::Options options;
    options.width = width_;
    options.height = height_;
    options.frame = common.frame;
    options.view = common.from;
    render::Picture picture;
    int frame = 0;
    const auto show = [&] {
      writer.add(curve_.times.empty() ? picture
                                      : render::with_curve(picture, curve_, frame * between_s_, strip_));
      callbacks.report(static_cast<double>(++frame) / count());
    };
    snapshots_.rewind();
    for (WorldSnapshot snapshot; !writer.idle() && snapshots_.next(snapshot);) {
      while (!picture.rgba.empty() && frame < frame_at(snapshot.time)) show();
      if (callbacks.stopped()) break;
      if (!snapshot.handle) snapshot.handle = first_handle_;  // no tick yet
      render::Scene scene = scene_of(world, snapshot, shade_);
      add_obstacles(scene, world, common.view);
      scene.scale = common.scale;
      scene.title = world.description.name;
      scene.subtitle = fmt::format("t = {:.4f} s", snapshot.time);
      picture = render::draw(scene, options);
      show();
    }
    while (!callbacks.stopped() && !writer.idle() && frame < count()) show();
    writer.close();
  } catch (const Error& e) { writer.give_up(e); }
}

}  // namespace palpate::session
