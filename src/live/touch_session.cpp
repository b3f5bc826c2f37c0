#include "live/touch_session.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "core/clock.h"
#include "core/time_text.h"
#include "live/pace.h"
#include "live/page_hands.h"
#include "live/scene_messages.h"
#include "live/world_observer.h"
#include "loop/choose_scheme.h"
#include "palpate/core/error.h"
#include "palpate/loop/run.h"
#include "session/run_session.h"

namespace palpate::live {
namespace {

using scene::ExchangeScheme;

/// State that viewers chose.
struct Setup {
  std::string scene;
  std::vector<std::string> overrides;
  std::map<std::string, double> values;  ///< Value of each slider, by its key
  bool record = false;
};

class TouchSession {
 public:
  explicit TouchSession(TouchOptions options) : options_(std::move(options)) {
    setup_.scene = options_.scene;
    setup_.overrides = options_.overrides;
  }

  void run() {
    description_of(setup_);  // reports an invalid scene before the server starts
    const Server server(options_.server, controls_, broadcast_, options_.stop);
    if (options_.started) options_.started(server);
    bool idle = false, first = true;
    while (!stopped()) {
      const Requests requests = controls_.take();
      if (requests.quit) break;
      if (requests.any()) idle = false;
      apply(requests);
      if (idle) {
        controls_.wait(0.2);
        continue;
      }
      try {
        idle = !one_run();
      } catch (const Error& error) {
        if (first) throw;
        idle = true;
        show_error(error.what());
      }
      first = false;
    }
  }

 private:
  bool stopped() const { return options_.stop && *options_.stop; }

  void apply(const Requests& requests) {
    if (requests.open) {
      setup_ = {};
      setup_.scene = *requests.open;
      controls_.pause() = false;
    }
    for (const auto& [key, value] : requests.values) setup_.values[key] = value;
    setup_.record = requests.record.value_or(false);
  }

  void show_error(const std::string& what) {
    options_.report("palpate: error: " + what);
    broadcast_.change([&](SessionState& state) {
      state.running = false;
      state.recording.reset();
      state.message = "stopped by an error; reset it, or open another scene";
    });
    broadcast_.send(notice_text("error", what));
  }

  std::vector<std::string> overrides_of(const Setup& setup) const {
    std::vector<std::string> out = setup.overrides;
    if (!options_.scheme.empty()) out.push_back(fmt::format("exchange.scheme=\"{}\"", options_.scheme));
    for (const auto& [key, value] : setup.values) out.push_back(fmt::format("{}={}", key, value));
    return out;
  }

  /// Loads the scene with a scheme that a handle without a known path can have.
  scene::Description description_of(const Setup& setup) {
    std::vector<std::string> overrides = overrides_of(setup);
    scene::Description out = options_.load(setup.scene, overrides);
    if (!out.tool) return out;
    if (out.exchange.scheme == ExchangeScheme::kMonolithic) {
      if (!options_.scheme.empty())
        fail("--scheme monolithic: needs the handle's path in advance; use partitioned, single_rate or auto");
      overrides.push_back("exchange.scheme=\"auto\"");
      out = options_.load(setup.scene, overrides);
    }
    if (out.exchange.scheme != ExchangeScheme::kAuto) return out;
    auto [found, is_new] = schemes_.try_emplace(setup.scene, ExchangeScheme::kPartitioned);
    if (is_new) {
      const loop::SchemeChoice choice = loop::choose_scheme(out);
      found->second = choice.scheme;
      options_.report(choice.text());
    }
    return loop::with_scheme(out, found->second);
  }

  std::string short_name() const { return std::filesystem::path(setup_.scene).stem().string(); }

  std::string new_folder() const {
    for (int i = 1;; ++i) {
      const auto folder =
          std::filesystem::path(options_.folder) / fmt::format("{}-touch-{}", short_name(), i);
      if (!std::filesystem::exists(folder)) return folder.string();
    }
  }

  /// Assembles the scene and runs it until a request ends it. Returns false if the run failed.
  bool one_run() {
    broadcast_.change([&](SessionState& state) {
      state.running = false;
      state.message = "assembling " + short_name();
    });
    const scene::Description description = description_of(setup_);
    const bool has_hand = description.tool.has_value();
    WorldObserver observer;
    Pace pace(controls_, observer);
    std::vector<loop::Observer*> observers = {&observer};
    if (!has_hand) observers.push_back(&pace);
    PageHands hands = page_hands_of(description);
    return setup_.record ? recorded_run(description, observer, std::move(observers), std::move(hands))
                         : plain_run(description, observer, std::move(observers), std::move(hands));
  }

  static double duration_of(const scene::Description& description) {
    constexpr double kPeriods = 9e8;  // virtual time counts its periods; 10 years of 10 ms
    return description.tool ? std::numeric_limits<double>::infinity()
                            : kPeriods * loop::period_of(description);
  }

  void show(const loop::World& world, WorldObserver& observer, const HandleMailboxes& mailboxes,
            std::optional<Recording> recording) {
    Setup plain = setup_;
    plain.values.clear();
    const std::vector<std::pair<std::string, double>> values(setup_.values.begin(), setup_.values.end());
    const auto live = std::make_shared<LiveScene>(
        world, setup_.scene, sliders_of(options_.load(plain.scene, overrides_of(plain)), values), mailboxes);
    live->is_recorded = recording.has_value();
    observer.attach(live, world);
    broadcast_.change([&](SessionState& state) {
      state.scene = live;
      state.recording = std::move(recording);
      state.message.clear();
      state.running = true;
    });
  }

  bool plain_run(const scene::Description& description, WorldObserver& observer,
                 std::vector<loop::Observer*> observers, PageHands hands) {
    const auto world = loop::assemble(description, std::move(hands.devices));
    loop::check_clock(*world, description.tool.has_value());
    show(*world, observer, hands.mailboxes, {});
    loop::RunOptions run;
    run.duration_s = duration_of(description);
    run.real_time = description.tool.has_value();
    run.observers = std::move(observers);
    run.stop = &controls_.leave();
    run.pause = &controls_.pause();
    const loop::RunResult result = loop::run(*world, run);
    if (result.status.ok()) return true;
    show_error(fmt::format("{} failed at t = {} s: {}", description.integrator.name,
                           time_text(result.status.t), result.status.message));
    return false;
  }

  bool recorded_run(scene::Description description, WorldObserver& observer,
                    std::vector<loop::Observer*> observers, PageHands hands) {
    if (!description.record) description.record = RecordSpec{.states = !description.tool.has_value()};
    description.record->forces = description.tool.has_value();
    session::Options options;
    options.scene.scene = setup_.scene;
    options.scene.overrides = overrides_of(setup_);
    options.folder = new_folder();
    options.duration_s = duration_of(description);
    options.real_time = description.tool.has_value();
    options.command = "palpate touch " + setup_.scene;
    session::RunSession run(options, description, nullptr,
                            {std::move(hands.devices), std::move(observers), &controls_.pause()});
    show(run.world(), observer, hands.mailboxes, Recording{options.folder, wall_seconds()});
    options_.report("recording into " + options.folder);
    session::Callbacks callbacks;
    callbacks.stop = &controls_.leave();
    run.simulate(callbacks);
    run.write_results();
    finish_recording(run, options.folder);
    if (const std::string why = run.failure(); !why.empty()) {
      show_error(why);
      return false;
    }
    return true;
  }

  void finish_recording(const session::RunSession& run, const std::string& folder) {
    const double duration_s = run.output().result.time;
    const std::string command =
        (run.world().description.tool ? "palpate replay " : "palpate movie ") + folder;
    broadcast_.change([](SessionState& state) {
      state.recording.reset();
      state.running = false;
    });
    broadcast_.send(recorded_text(folder, duration_s, command));
    options_.report(
        fmt::format("recorded {} s in {}; repeat it: {}", time_text(duration_s), folder, command));
    for (const std::string& missing : run.output().missing.outputs()) {
      options_.report("palpate: missing: " + missing);
      broadcast_.send(notice_text("warning", "missing: " + missing));
    }
  }

  TouchOptions options_;
  Setup setup_;
  Controls controls_;
  Broadcast broadcast_;
  std::map<std::string, ExchangeScheme> schemes_;  ///< Choices for exchange.scheme = "auto"
};

}  // namespace

void run_touch_session(TouchOptions options) { TouchSession(std::move(options)).run(); }

}  // namespace palpate::live
