#include "session/command_line.h"

#include <fmt/format.h>

namespace palpate::session {

std::string quoted(const std::string& word) {
  if (word.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./=,:+@%") ==
          std::string::npos &&
      !word.empty())
    return word;
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string command_of(const Options& a) {
  if (!a.command.empty()) return a.command;
  std::string out = "palpate run " + quoted(a.scene.scene.empty() ? "scene.toml" : a.scene.scene);
  for (const std::string& change : a.scene.overrides) out += " --set " + quoted(change);
  if (!a.scene.integrator.empty()) out += " --integrator " + quoted(a.scene.integrator);
  if (a.duration_s > 0.0) out += fmt::format(" --duration-s {}", a.duration_s);
  if (a.picture) out += " --picture";
  if (a.contact_picture) out += " --contact-picture";
  if (a.frames) out += " --frames";
  if (a.frames && a.frames_per_s > 0.0) out += fmt::format(" --frames-per-s {}", a.frames_per_s);
  if (!a.movie.empty()) out += " --movie " + quoted(a.movie);
  if (a.fps > 0.0) out += fmt::format(" --fps {}", a.fps);
  if (a.slow != 1.0) out += fmt::format(" --slow {}", a.slow);
  if (!a.size.empty()) out += " --size " + a.size;
  if ((a.picture || a.draws_frames()) && a.shade != "displacement") out += " --shade " + a.shade;
  if (a.report) out += " --report";
  if (a.passivity != "off") out += " --passivity " + a.passivity;
  if (a.real_time) out += " --realtime";
  if (a.trace) out += " --trace";
  if (a.against_monolithic) out += " --against-monolithic";
  if (a.checkpoint_every_s > 0.0) out += fmt::format(" --checkpoint-every {}", a.checkpoint_every_s);
  return a.folder.empty() ? out : out + " -o " + quoted(a.folder);
}

}  // namespace palpate::session
