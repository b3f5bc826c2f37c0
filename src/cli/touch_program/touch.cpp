#include "touch.h"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "browser.h"
#include "cli/option_checks.h"
#include "cli/paths.h"
#include "cli/program.h"
#include "cli/scene_of.h"
#include "cli/stop.h"
#include "input_end.h"
#include "live/touch_session.h"

namespace palpate::cli {
namespace fs = std::filesystem;
namespace {

struct TouchArguments {
  SceneArguments scene;
  std::string address = "127.0.0.1", scheme;
  int port = 0;
  bool no_browser = false, notebook = false;
};

constexpr const char* kTouchFooter = R"(Examples:
  palpate touch                                  the head of `palpate list scenes`, in your browser
  palpate touch press-ball --set body.0.youngs_modulus_pa=2e4
  palpate touch my.toml --scheme single_rate     tool and bodies at one rate
  palpate touch --no-browser --port 8800         prints the address only

Drag on the page to move the handle.  The page has sliders, reset, pause, and record: a recording is a run
folder (out/SCENE-touch-N), which `palpate replay` repeats.  Ctrl-C ends the session.

On another machine: run there with --no-browser and --port 8800, on your own machine
  ssh -L 8800:127.0.0.1:8800 MACHINE
and open the printed address in your own browser.  `palpate help live` says more.)";

/// Returns the scenes that viewers may open: the given one, then those that come with palpate.
std::vector<live::SceneEntry> entries(const std::string& given) {
  std::vector<live::SceneEntry> out;
  for (const std::string& path : shipped_scenes()) {
    fs::path picture = fs::path(path).replace_extension(".png");
    out.push_back({fs::path(path).stem().string(), first_comment(path),
                   fs::is_regular_file(picture) ? picture.string() : std::string()});
  }
  const bool is_shipped =
      std::any_of(out.begin(), out.end(), [&](const live::SceneEntry& one) { return one.name == given; });
  if (!is_shipped) out.insert(out.begin(), {given, first_comment(find_scene(given)), {}});
  return out;
}

void print_line(const std::string& line) {
  fmt::print("{}\n", line);
  std::fflush(stdout);
}

void announce(const live::Server& server, ForwardingPage& page, bool no_browser) {
  print_line("palpate touch: " + server.url());
  const bool opened = !no_browser && has_display() && page.open(server.url());
  print_line(opened ? "opened in your browser; Ctrl-C ends it"
                    : "open this address in a browser; Ctrl-C ends it");
  if (!opened && std::getenv("SSH_CONNECTION"))
    print_line(fmt::format("from your own machine: ssh -L {0}:127.0.0.1:{0} THIS-MACHINE, then open it there",
                           server.port()));
}

int touch(const TouchArguments& arguments) {
  ForwardingPage page;
  std::optional<InputEnd> input_end;
  if (arguments.notebook) input_end.emplace();
  live::TouchOptions options;
  options.server.in_frames = arguments.notebook;
  options.server.address = arguments.address;
  options.server.port = arguments.port;
  options.server.scenes = entries(arguments.scene.scene);
  options.scene = arguments.scene.scene;
  options.overrides = arguments.scene.changes();
  options.scheme = arguments.scheme;
  options.load = [](const std::string& scene, const std::vector<std::string>& overrides) {
    SceneArguments one;
    one.scene = scene;
    one.overrides = overrides;
    return scene_of(one);
  };
  options.started = [&](const live::Server& server) {
    announce(server, page, arguments.no_browser || arguments.notebook);
  };
  options.report = print_line;
  options.stop = &stop_flag();
  live::run_touch_session(std::move(options));
  return 0;
}

}  // namespace

void add_touch(CLI::App& app, Invocation& invocation) {
  CLI::App* command = app.add_subcommand("touch", "touch a scene in a browser, in real time");
  auto arguments = std::make_shared<TouchArguments>();
  arguments->scene.scene = "touch-head";
  command->add_option("SCENE", arguments->scene.scene, kSceneHelp)->capture_default_str();
  command
      ->add_option("--set", arguments->scene.overrides,
                   "change one value of the scene: KEY=VALUE with a dotted key, table indices from 0, and a "
                   "TOML value; a text needs no quotes")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  command->add_option("--integrator", arguments->scene.integrator, "replace the scene's integrator")
      ->type_name("NAME");
  command
      ->add_option("--scheme", arguments->scheme,
                   "coupling of tool and bodies, for every scene; default: as the scene states, or auto for "
                   "monolithic")
      ->type_name("NAME")
      ->check(CLI::IsMember({"partitioned", "single_rate", "auto"}));
  command->add_option("--port", arguments->port, "TCP port of the page; 0: any free one")
      ->type_name("PORT")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  command
      ->add_option("--address", arguments->address,
                   "IPv4 address to listen on; others than 127.0.0.1 let other machines connect, without "
                   "encryption")
      ->type_name("ADDRESS")
      ->capture_default_str();
  command->add_flag("--no-browser", arguments->no_browser, "print the address only");
  command->add_flag(
      "--notebook", arguments->notebook,
      "for palpate.touch in Python: prints the address only, lets pages of this machine show the "
      "page in a frame, and ends with the standard input");
  command->footer(kTouchFooter);
  command->callback([arguments, &invocation] {
    invocation.factorises = true;
    invocation.action = [arguments] { return touch(*arguments); };
  });
}

}  // namespace palpate::cli
