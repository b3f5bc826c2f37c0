#include "frames.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "palpate/core/error.h"
#include "progress.h"
#include "stop.h"
#include "undelivered.h"

namespace palpate::cli {
namespace fs = std::filesystem;
namespace {

constexpr int kWidth = 960, kHeight = 720, kStrip = 150;  ///< pixels; even, as video encoders want them

/// The points that lie farthest in 26 directions: what a camera needs to frame them nearly as closely as all.
void add_extremes(const Points& points, std::vector<Vec3>& out) {
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z) {
        if (points.cols() == 0 || (x == 0 && y == 0 && z == 0)) continue;
        Eigen::Index farthest = 0;
        (Vec3(x, y, z).transpose() * points).maxCoeff(&farthest);
        out.push_back(points.col(farthest));
      }
}

/// What all frames share.
struct Common {
  render::ColourScale scale;
  Points frame;
  contact::View view;
  double grid_spacing = 0.0;
};

Common common_of(const loop::World& world, const std::vector<Instant>& instants, Shade shade) {
  Common out;
  double least = INFINITY, greatest = -INFINITY;
  std::vector<Vec3> extremes;
  for (const Instant& instant : instants) {
    const render::Scene scene = scene_of(world, instant, shade);
    out.scale = scene.scale;
    for (const render::Surface& surface : scene.surfaces) {
      add_extremes(surface.points, extremes);
      for (const double v : surface.values)
        if (std::isfinite(v)) least = std::min(least, v), greatest = std::max(greatest, v);
    }
  }
  out.scale = render::settled(out.scale, least, greatest);
  render::Scene all;
  render::Surface& ends = all.surfaces.emplace_back();
  ends.points.resize(3, static_cast<Eigen::Index>(extremes.size()));
  for (std::size_t i = 0; i < extremes.size(); ++i)
    ends.points.col(static_cast<Eigen::Index>(i)) = extremes[i];
  out.view = view_of(all);
  add_obstacles(all, world, out.view);
  for (const render::Surface& surface : all.surfaces)
    if (&surface != &all.surfaces[0]) add_extremes(surface.points, extremes);
  out.frame.resize(3, static_cast<Eigen::Index>(extremes.size()));
  for (std::size_t i = 0; i < extremes.size(); ++i) out.frame.col(static_cast<Eigen::Index>(i)) = extremes[i];
  return out;
}

fs::path frame_path(const std::string& folder, int index) {
  return fs::path(folder) / fmt::format("{:04}.png", index);
}

/// Numbered pictures, which would pass for this run's.
void remove_old(const std::string& folder) {
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    const std::string stem = entry.path().stem().string();
    if (entry.path().extension() == ".png" && stem.size() >= 4 &&
        stem.find_first_not_of("0123456789") == std::string::npos)
      fs::remove(entry.path(), none);
  }
}

void write_whole(const render::Picture& picture, const fs::path& path) {
  const fs::path draft = path.parent_path() / (path.stem().string() + ".part");
  try {
    render::save_png(picture, draft);
  } catch (const Error&) {
    std::error_code none;
    fs::remove(draft, none);
    throw;
  }
  std::error_code error;
  fs::rename(draft, path, error);
  if (error) fail("{}: cannot be written: {}", path.string(), error.message());
}

}  // namespace

Frames::Frames(const loop::World& world, Shade shade, double per_s, double duration_s)
    : shade_(shade), end_s_(duration_s) {
  const scene::Description& d = world.description;
  const double period = loop::period_of(d);
  double wanted = per_s > 0.0 ? 1.0 / per_s : d.record ? d.record->state_period_s : period;
  if (per_s > 0.0 && wanted < 0.999 * period)
    fail(
        "--frames-per-s {:g}: this scene can be seen every {:g} s, {:g} times a second of simulated time: "
        "that "
        "is the period of its loop ({}); ask for at most that, or shorten the period",
        per_s, period, 1.0 / period,
        d.tool && d.exchange.scheme != "monolithic" ? "exchange.exchange_period_s"
        : !d.contacts.empty()                       ? "exchange.contact_refresh_s"
                                                    : "record.state_period_s, else all of duration_s");
  every_ = std::max(1L, std::lround(wanted / period));
  between_s_ = static_cast<double>(every_) * period;
  if (world.description.tool)
    curve_ = {"force on the hand", "N", {}, {}};
  else if (world.contact)
    curve_ = {"contact force", "N", {}, {}};
}

void Frames::tick(const loop::TickRecord& tick) {
  curve_.times.push_back(tick.time);
  curve_.values.push_back(tick.device.force.norm());
}

void Frames::period(loop::World& world, double t) {
  due_ = periods_++ % every_ == 0 && t < end_s_ * (1.0 - 1e-9);
  if (due_ && shade_ != Shade::kPenetration) keep(world, t);
}

void Frames::queried(loop::World& world, double t) {
  if (!world.description.tool) {
    double force = 0.0;
    for (const contact::ContactPoint& p : world.contact->points(world.state.view()))
      force += p.pressure * p.area;
    curve_.times.push_back(t);
    curve_.values.push_back(force);
  }
  if (due_ && shade_ == Shade::kPenetration) keep(world, t);
}

void Frames::keep(loop::World& world, double t) {
  instants_.push_back(instant_of(world, t, shade_));
  due_ = false;
}

int Frames::save(const loop::World& world, const std::string& folder, bool stoppable,
                 Undelivered& missing) const {
  int written = 0;
  try {
    if (instants_.empty()) fail("the run ended before the first");
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) fail("{}: the folder cannot be made: {}", folder, error.message());
    remove_old(folder);
    const Common common = common_of(world, instants_, shade_);
    Progress progress("drawing frames");
    for (const Instant& instant : instants_) {
      if (stoppable && stop_flag().load()) return written;
      render::Scene scene = scene_of(world, instant, shade_);
      add_obstacles(scene, world, common.view);
      scene.scale = common.scale;
      scene.title = world.description.name;
      scene.subtitle = fmt::format("t = {:.4f} s", instant.time);
      render::Options options;
      options.width = kWidth;
      options.height = kHeight;
      options.frame = common.frame;
      render::Picture picture = render::draw(scene, options);
      if (!curve_.times.empty()) picture = render::with_curve(picture, curve_, instant.time, kStrip);
      write_whole(picture, frame_path(folder, written));
      ++written;
      progress(static_cast<double>(written) / count());
    }
  } catch (const Error& e) {
    missing.add(fmt::format("frame {} and those behind it", frame_path(folder, written).string()), e.what());
  }
  return written;
}

}  // namespace palpate::cli
