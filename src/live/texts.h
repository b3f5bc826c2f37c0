#pragma once
#include <string>

#include "live/broadcast.h"
#include "live/timing_window.h"

/// Text messages to viewers (docs/live.md), in JSON.
namespace palpate::live {

/// Holder of the handle and number of viewers, as one viewer sees them.
struct ViewerPlace {
  const char* holder = "nobody";  ///< Who holds the handle: "you", "other" or "nobody"
  std::size_t viewers = 0;
};

/// Returns the message `state`.  @param now_s  wall clock  @param paused  whether viewers paused the run
std::string state_text(const LiveStatus& status, const SessionState& session, bool paused,
                       const ViewerPlace& place, double now_s);
/// Returns a message `scene` with another value of a slider.
std::string with_slider_value(const std::string& scene_message, const std::string& key, double value);
/// Returns the message `notice`.  @param level  "info", "warning" or "error"
std::string notice_text(const char* level, const std::string& text);
/// Returns the message `recorded`.  @param command  command that repeats or shows the recording
std::string recorded_text(const std::string& folder, double duration_s, const std::string& command);

}  // namespace palpate::live
