// Runs by the library, without the command line: their files, checkpoints, summaries and errors.
#include "session/run_session.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <map>

#include "palpate/core/error.h"
#include "palpate/loop/load.h"
#include "palpate/store/run_file.h"
#include "session/resumption.h"
#include "session/run_remarks.h"
#include "store/summary.h"
#include "temporary_folder.h"

using namespace palpate;
namespace fs = std::filesystem;

namespace {

constexpr const char* kBar = R"(
[scene]
name = "bar"
duration_s = 0.1
gravity_m_s2 = [0.0, 0.0, -9.81]
[[body]]
name = "bar"
youngs_modulus_pa = 5e5
poissons_ratio = 0.3
density_kg_m3 = 1000.0
stiffness_damping_s = 2e-3
mesh = {generator = "box", size_m = [0.2, 0.04, 0.04], element_size_m = 0.04}
[[body.attachment]]
box_min_m = [-0.101, -0.1, -0.1]
box_max_m = [-0.099, 0.1, 0.1]
[integrator]
name = "cvode-bdf"
rtol = 1e-3
)";
constexpr const char* kRecord = "[record]\nstate_period_s = 0.01\n";

// Energy kept from the hand has either sign: a removed force may have driven the handle, or resisted it.
TEST(PortRemark, states_a_positive_energy_and_who_had_it) {
  const loop::PortEnergy observed{.energy = 0.0126, .least = -0.001, .work = 0.1};
  EXPECT_EQ(session::port_remark(observed),
            "energy at the device port: minimum -0.001 J, at the end 0.0126 J");
  loop::PortEnergy controlled = observed;
  controlled.least = 0.0;
  controlled.controller_ticks = 2;
  controlled.controller_dissipated = 0.002;
  EXPECT_EQ(
      session::port_remark(controlled),
      "energy at the device port: minimum 0 J, at the end 0.0126 J; the passivity controller reduced the "
      "force in 2 ticks, which kept 0.002 J from the hand (2 % of the motors' work)");
  controlled.controller_ticks = 1;
  controlled.controller_dissipated = -0.002;
  EXPECT_EQ(
      session::port_remark(controlled),
      "energy at the device port: minimum 0 J, at the end 0.0126 J; the passivity controller reduced the "
      "force in 1 tick, which spared the hand 0.002 J of work (2 % of the motors' work)");
}

class RunSession : public testing::Test {
 protected:
  /// Loads a scene from a file in the folder, as a front end does.
  scene::Description load(const std::string& text, session::Options& options) {
    options.scene.scene = folder_.write("bar.toml", text).string();
    return loop::load(options.scene.scene, options.scene.overrides);
  }
  session::Options options_into(const char* folder) {
    session::Options out;
    out.folder = (folder_ / folder).string();
    return out;
  }
  static store::Summary summary_in(const std::string& folder) {
    return store::read_summary((fs::path(folder) / "summary.json").string());
  }
  static std::string message_of(const session::Options& options, const scene::Description& description) {
    try {
      session::RunSession(options, description);
    } catch (const Error& e) { return e.what(); }
    return "no error";
  }

  TemporaryFolder folder_;
};

scene::Description load_again(const scene::SceneArguments& scene) {
  return loop::load(scene.scene, scene.changes());
}

/// Positions of all recorded states.
std::vector<Points> states_in(const std::string& folder) {
  const store::RunReader reader((fs::path(folder) / "run.vtkhdf").string());
  std::vector<Points> out;
  for (int step = 0; step < reader.steps(); ++step) out.push_back(reader.points(step));
  return out;
}

/// Counts of constructions in a summary, by name.
std::map<std::string, long long> constructions_in(store::Summary summary) {
  std::map<std::string, long long> out;
  for (const store::SummaryFields& row : summary.list("constructions"))
    out[std::get<std::string>(row.at(0).second)] = std::get<long long>(row.at(1).second);
  return out;
}

}  // namespace

TEST_F(RunSession, WritesWhatTheSceneRecordsAndASummary) {
  session::Options options = options_into("out");
  const scene::Description description = load(std::string(kBar) + kRecord, options);
  session::RunSession run(options, description);
  EXPECT_EQ(summary_in(options.folder).outcome, "unfinished");  // remains if the process is killed
  double last = 0.0;
  session::Callbacks callbacks;
  callbacks.progress = [&last](double share) { last = share; };
  run.run(callbacks);
  EXPECT_NEAR(last, 1.0, 1e-12);
  EXPECT_TRUE(run.output().is_complete());
  EXPECT_TRUE(run.failure().empty());
  EXPECT_TRUE(run.output().missing.empty());
  EXPECT_EQ(run.output().folder, options.folder);
  EXPECT_EQ(states_in(options.folder).size(), 11u);
  const store::Summary kept = summary_in(options.folder);
  EXPECT_EQ(kept.outcome, "finished");
  EXPECT_EQ(kept.command, "palpate run " + options.scene.scene + " -o " + options.folder);
  EXPECT_EQ(kept.scene_source, description.source);
  store::Summary returned = run.summary();
  EXPECT_EQ(returned.outcome, kept.outcome);
  EXPECT_EQ(constructions_in(returned), constructions_in(kept));
}

TEST_F(RunSession, CountsOnlyItsOwnConstructions) {
  session::Options options = options_into("out");
  const scene::Description description = load(std::string(kBar) + kRecord, options);
  std::map<std::string, long long> counts[2];
  for (auto& count : counts) {
    session::RunSession run(options, description);
    run.run();
    count = constructions_in(run.summary());
  }
  EXPECT_FALSE(counts[0].empty());
  EXPECT_EQ(counts[0], counts[1]);
}

TEST_F(RunSession, WithoutAnOutputWritesNoFile) {
  session::Options options;
  const scene::Description description = load(kBar, options);
  const fs::path before = fs::current_path();
  fs::current_path(folder_.path());
  session::RunSession run(options, description);
  run.run();
  fs::current_path(before);
  EXPECT_TRUE(run.output().folder.empty());
  EXPECT_FALSE(fs::exists(folder_ / "out"));
  EXPECT_EQ(run.summary().outcome, "finished");
}

TEST_F(RunSession, ResumedFromACheckpointIsBitwiseEqual) {
  session::Options whole = options_into("whole");
  whole.checkpoint_every_s = 0.02;
  const scene::Description description = load(std::string(kBar) + kRecord, whole);
  session::RunSession(whole, description).run();
  EXPECT_FALSE(fs::exists(session::checkpoint_path(whole.folder)));  // removed at the end

  session::Options half = options_into("half");
  half.checkpoint_every_s = 0.02;
  half.scene = whole.scene;
  std::atomic<bool> stop{false};
  session::Callbacks callbacks;
  callbacks.progress = [&stop](double share) { stop = share > 0.45; };
  callbacks.stop = &stop;
  {
    session::RunSession run(half, description);
    run.run(callbacks);
    EXPECT_TRUE(run.output().result.stopped);
    EXPECT_EQ(run.output().checkpoints.written, 2);
    EXPECT_EQ(run.summary().outcome, "interrupted");
  }
  EXPECT_FALSE(session::is_finished_run(half.folder));
  EXPECT_LT(states_in(half.folder).size(), 11u);

  session::Resumption resumption = session::read_resumption(half.folder);
  EXPECT_NEAR(resumption.checkpoint.time_s, 0.04, 1e-9);
  EXPECT_TRUE(session::processor_differences(resumption).empty());
  EXPECT_EQ(session::scene_to_resume(resumption, load_again).source, description.source);
  session::RunSession rest(resumption.identity.options, description, &resumption);
  rest.run();
  EXPECT_TRUE(rest.output().is_complete());
  EXPECT_EQ(rest.output().checkpoints.written, 4);
  EXPECT_TRUE(session::is_finished_run(half.folder));
  EXPECT_FALSE(fs::exists(session::checkpoint_path(half.folder)));
  const std::vector<Points> expected = states_in(whole.folder), actual = states_in(half.folder);
  ASSERT_EQ(actual.size(), 11u);
  for (std::size_t i = 0; i < actual.size(); ++i) EXPECT_EQ(actual[i], expected[i]) << i;
  EXPECT_NE(actual[4], actual[10]);
  EXPECT_EQ(constructions_in(summary_in(half.folder)), constructions_in(summary_in(whole.folder)));
}

TEST_F(RunSession, ResumingRequiresTheSameSceneAndACheckpoint) {
  EXPECT_THROW(session::read_resumption((folder_ / "none").string()), Error);
  EXPECT_THROW(session::is_finished_run((folder_ / "none").string()), Error);
  session::Options options = options_into("out");
  options.checkpoint_every_s = 0.02;
  const scene::Description description = load(std::string(kBar) + kRecord, options);
  std::atomic<bool> stop{false};
  session::Callbacks callbacks;
  callbacks.progress = [&stop](double share) { stop = share > 0.45; };
  callbacks.stop = &stop;
  session::RunSession(options, description).run(callbacks);
  session::Resumption resumption = session::read_resumption(options.folder);
  folder_.write("bar.toml", std::string(kBar) + kRecord + "# a comment\n");
  EXPECT_THROW(session::scene_to_resume(resumption, load_again), Error);
  fs::remove(options.scene.scene);
  EXPECT_THROW(session::scene_to_resume(resumption, load_again), Error);
  resumption.identity.options.scene.scene = "";  // made from a text, without a file
  EXPECT_EQ(session::scene_to_resume(resumption, load_again).source, description.source);
}

TEST_F(RunSession, AFileThatCannotBeWrittenIsMissingAndTheRestIsComplete) {
  session::Options options = options_into("out");
  const scene::Description description = load(std::string(kBar) + kRecord, options);
  fs::create_directories(fs::path(options.folder) / "run.xdmf" / "full");  // in the place of the sidecar
  session::RunSession run(options, description);
  run.run();
  ASSERT_EQ(run.output().missing.outputs().size(), 1u);
  EXPECT_TRUE(run.output().missing.outputs()[0].starts_with("sidecar " + options.folder + "/run.xdmf ("))
      << run.output().missing.outputs()[0];
  EXPECT_EQ(summary_in(options.folder).outcome, "finished");
  EXPECT_EQ(states_in(options.folder).size(), 11u);
}

TEST_F(RunSession, ALockedFolderIsRefusedAndKept) {
  session::Options options = options_into("out");
  const scene::Description description = load(std::string(kBar) + kRecord, options);
  {
    const store::FolderLock lock(options.folder);
    const std::string message = message_of(options, description);
    EXPECT_NE(message.find("is writing into this folder"), std::string::npos) << message;
    EXPECT_TRUE(fs::is_empty(options.folder));
  }
  session::RunSession first(options, description);  // holds it until the session ends
  EXPECT_NE(message_of(options, description).find("is writing into this folder"), std::string::npos);
}

TEST_F(RunSession, AnIntegratorThatFailsIsAResult) {
  session::Options options = options_into("out");
  options.scene.overrides = {"integrator.max_steps=1", "integrator.rtol=1e-9"};
  const scene::Description description = load(std::string(kBar) + kRecord, options);
  session::RunSession run(options, description);
  run.run();
  EXPECT_FALSE(run.output().is_complete());
  EXPECT_TRUE(run.failure().starts_with("cvode-bdf failed at t = ")) << run.failure();
  const store::Summary summary = summary_in(options.folder);
  EXPECT_EQ(summary.outcome, "failed");
  EXPECT_EQ(summary.overrides, options.scene.overrides);
}

TEST_F(RunSession, OptionsThatExcludeEachOtherAreRefusedBeforeAnythingIsWritten) {
  session::Options options = options_into("out");
  const scene::Description description = load(std::string(kBar) + kRecord, options);
  const auto with = [&](auto change) {
    session::Options changed = options;
    change(changed);
    return message_of(changed, description);
  };
  EXPECT_EQ(with([](auto& o) { o.passivity = "contrl"; }),
            "passivity: unknown mode \"contrl\" (did you mean \"control\"?)");
  EXPECT_EQ(with([](auto& o) { o.contact_picture = true; }),
            "--contact-picture: the scene has no [[contact]]");
  EXPECT_EQ(with([](auto& o) { o.size = "640x480"; }), "--size needs --frames or --movie");
  EXPECT_TRUE(with([](auto& o) {
                o.checkpoint_every_s = 0.02, o.trace = true;
              }).starts_with("--checkpoint-every cannot be combined with --trace"));
  EXPECT_FALSE(fs::exists(options.folder));
}
