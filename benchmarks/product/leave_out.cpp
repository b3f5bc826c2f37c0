#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <functional>

#include "contact/gpu_device.h"
#include "core/clock.h"
#include "core/program.h"
#include "palpate/core/error.h"
#include "palpate/loop/recorder.h"
#include "palpate/loop/run.h"
#include "palpate/tool/tool.h"
#include "product/bench.h"

namespace palpate::bench {
namespace {

struct Figures {
  double startup_ms, memory_mib, step_ms;
};

/// Runs `measure` in a child process, so that libraries and memory of one variant do not affect the next.
Figures in_child(const std::function<Figures()>& measure) {
  int ends[2];
  PALPATE_CHECK(pipe(ends) == 0, "pipe failed");
  const pid_t child = fork();
  PALPATE_CHECK(child >= 0, "fork failed");
  if (child == 0) {
    int status = 0;
    try {
      const Figures figures = measure();
      static_cast<void>(!write(ends[1], &figures, sizeof figures));
    } catch (const std::exception& e) {
      static_cast<void>(!write(ends[1], e.what(), std::char_traits<char>::length(e.what())));
      status = 1;
    }
    _exit(status);
  }
  close(ends[1]);
  std::string said;  // The figures, or the reason why there are none.
  std::array<char, 4096> part{};
  for (ssize_t n = 0; (n = read(ends[0], part.data(), part.size())) > 0;)
    said.append(part.data(), static_cast<std::size_t>(n));
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 1) fail("bench leave-out: {}", said);
  if (status != 0 || said.size() != sizeof(Figures))
    fail("bench leave-out: a measured process terminated abnormally (status {})", status);
  Figures figures{};
  std::memcpy(&figures, said.data(), sizeof figures);
  return figures;
}

/// Runs the loop that a user would write by hand over the same parts: query, restart, advance.
Figures bare_loop(const scene::Description& d) {
  const double start = wall_seconds();
  const auto world = loop::assemble(d);
  Figures out{};
  out.startup_ms = 1e3 * (wall_seconds() - start);
  const double period = loop::period_of(d);
  const int periods = static_cast<int>(d.duration_s / period + 0.5);
  const double t0 = wall_seconds();
  for (int i = 0; i < periods; ++i) {
    if (world->contact && world->contact->refresh(world->state.view()))
      world->stepper->reinit(dynamics::ReinitReason::kContactRefreshed);
    if (!world->stepper->advance_to((i + 1) * period).ok()) fail("the bare loop's integrator failed");
  }
  out.step_ms = 1e3 * (wall_seconds() - t0) / periods;
  out.memory_mib = resident_memory_mib();
  return out;
}

Figures palpate_loop(const scene::Description& d, bool record) {
  const double start = wall_seconds();
  const auto world = loop::assemble(d);
  const std::string folder =
      (std::filesystem::path(temporary_folder()) / fmt::format("palpate-leave-out-{}", getpid())).string();
  std::unique_ptr<loop::Recorder> recorder;
  if (record) recorder = std::make_unique<loop::Recorder>(*world, folder);
  Figures out{};
  out.startup_ms = 1e3 * (wall_seconds() - start);
  loop::RunOptions options;
  if (record) options.observers = {recorder.get()};
  const loop::RunResult result = loop::run(*world, options);
  if (!result.status.ok()) fail("{}", result.status.message);
  out.step_ms = 1e3 * result.wall_s / static_cast<double>(result.periods);
  out.memory_mib = resident_memory_mib();
  recorder.reset();
  std::filesystem::remove_all(folder);
  return out;
}

scene::Description with_tool_out_of_reach(scene::Description d) {
  const double period = loop::period_of(d);
  d.tool.emplace();
  d.tool->position_m = Vec3(0, 0, 100);
  d.tool->tick_s = period / 10;
  d.device.emplace();
  d.device->keyframes.push_back({0.0, Vec3(0, 0, 100), Vec3::Zero(), Interpolation::kStep});
  d.exchange.exchange_period_s = d.exchange.contact_refresh_s = period;
  return d;
}

scene::Description with_image_contact_out_of_reach(const scene::Description& d) {
  scene::Description out = with_tool_out_of_reach(d);
  ContactSpec contact;
  contact.first = d.bodies.front().name;
  contact.second = "tool";
  contact.method = "image";
  out.contacts.push_back(contact);
  return out;
}

scene::Description with_plane_out_of_reach(scene::Description d) {
  const double period = loop::period_of(d);
  ObstacleSpec plane;
  plane.name = "far below";
  plane.type = "plane";
  plane.shape["position_m"] = Vec3(0, 0, -100);
  d.obstacles.push_back(plane);
  ContactSpec contact;
  contact.first = d.bodies.front().name;
  contact.second = plane.name;
  d.contacts.push_back(contact);
  d.exchange.contact_refresh_s = period;
  return d;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

struct Variant {
  std::string name;
  std::function<Figures()> measure;
};

std::vector<Variant> variants_of(const scene::Description& d) {
  scene::Description quiet = d;
  quiet.exchange.contact_refresh_s = quiet.exchange.exchange_period_s = loop::period_of(d);
  scene::Description recorded = quiet;
  if (!recorded.record) recorded.record.emplace();
  std::vector<Variant> out;
  out.push_back({"bare loop over the same components", [quiet] { return bare_loop(quiet); }});
  out.push_back({"palpate, scene as given", [quiet] { return palpate_loop(quiet, false); }});
  out.push_back({"... and recording", [recorded] { return palpate_loop(recorded, true); }});
  out.push_back({"... and a plane out of reach",
                 [quiet] { return palpate_loop(with_plane_out_of_reach(quiet), false); }});
  if (!tool::available()) return out;
  out.push_back({"... and a tool out of reach",
                 [quiet] { return palpate_loop(with_tool_out_of_reach(quiet), false); }});
  if (!contact::gpu_available()) return out;
  out.push_back({"... with contact in image space",
                 [quiet] { return palpate_loop(with_image_contact_out_of_reach(quiet), false); }});
  return out;
}

}  // namespace

std::vector<LeaveOutRow> bench_leave_out(const scene::Description& d, int repeats) {
  if (d.tool)
    fail("scene \"{}\" has a tool; bench leave-out requires a scene without one (falling-ball, cantilever)",
         d.name);
  if (d.bodies.empty()) fail("scene \"{}\" has no body to step", d.name);
  const std::vector<Variant> variants = variants_of(d);
  std::vector<std::vector<Figures>> runs(variants.size());
  for (int r = 0; r < repeats; ++r)
    for (std::size_t v = 0; v < variants.size(); ++v) runs[v].push_back(in_child(variants[v].measure));
  std::vector<LeaveOutRow> rows;
  for (std::size_t v = 0; v < variants.size(); ++v) {
    std::vector<double> startup, memory, step, ratio;
    for (std::size_t r = 0; r < runs[v].size(); ++r) {
      startup.push_back(runs[v][r].startup_ms);
      memory.push_back(runs[v][r].memory_mib);
      step.push_back(runs[v][r].step_ms);
      ratio.push_back(runs[v][r].step_ms / runs[0][r].step_ms);
    }
    rows.push_back({variants[v].name, median(startup), median(memory), median(step), median(ratio)});
  }
  return rows;
}

}  // namespace palpate::bench
