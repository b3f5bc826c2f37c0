#include "live/texts.h"

#include <nlohmann/json.hpp>

namespace palpate::live {
namespace {

using nlohmann::json;

std::string text_of(const json& message) {
  return message.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace

std::string state_text(const LiveStatus& status, const SessionState& session, bool paused,
                       const ViewerPlace& place, double now_s) {
  json out = {{"type", "state"},
              {"time_s", status.time_s},
              {"running", session.running && !paused},
              {"rate_hz", status.rate_hz},
              {"late_share", status.late_share},
              {"skipped_ticks", status.skipped_ticks},
              {"late_p99_s", status.late_p99_s},
              {"work_p50_s", status.work_p50_s},
              {"work_p99_s", status.work_p99_s},
              {"holder", place.holder},
              {"viewers", place.viewers}};
  out["energy_j"] = status.has_energy ? json(status.energy_j) : json(nullptr);
  out["passivity"] = {{"observed", session.scene && session.scene->has_hand},
                      {"energy_j", status.port_energy_j},
                      {"min", status.least_port_energy_j}};
  out["recording"] = nullptr;
  if (session.recording)
    out["recording"] = {{"folder", session.recording->folder},
                        {"since_s", now_s - session.recording->start_s}};
  out["message"] = session.message.empty() ? json(nullptr) : json(session.message);
  return text_of(out);
}

std::string with_slider_value(const std::string& scene_message, const std::string& key, double value) {
  json message = json::parse(scene_message);
  for (json& slider : message["sliders"])
    if (slider["key"] == key) slider["value"] = value;
  return text_of(message);
}

std::string notice_text(const char* level, const std::string& text) {
  return text_of({{"type", "notice"}, {"level", level}, {"text", text}});
}

std::string recorded_text(const std::string& folder, double duration_s, const std::string& command) {
  return text_of({{"type", "recorded"}, {"folder", folder}, {"duration_s", duration_s}, {"replay", command}});
}

}  // namespace palpate::live
