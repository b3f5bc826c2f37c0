#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "live/controls.h"
#include "live/live_scene.h"
#include "live/messages.h"
#include "live/texts.h"

namespace palpate::live {

/// Limits of viewers.
struct ViewerLimits {
  std::size_t viewers = 8;
  double messages_per_s = 300.0;  ///< Beyond it, messages of a viewer are dropped.
  int bad_messages = 20;          ///< A viewer that sent so many is disconnected.
};

/// Viewers, and their rights: one of them holds the handle, and it alone moves it. While somebody holds the
/// handle, only the holder may change the run; otherwise everybody may. Used by the server's thread alone.
class Viewers {
 public:
  /// @param scenes  names of the scenes that may be opened
  Viewers(Controls& controls, std::vector<std::string> scenes, const ViewerLimits& limits = {});

  bool is_full() const { return viewers_.size() >= limits_.viewers; }
  std::size_t count() const { return viewers_.size(); }
  /// Adds a viewer and returns its number.
  int add();
  /// Removes a viewer; if it holds the handle, nobody does afterwards.
  void remove(int viewer);
  /// Sets the scene that is shown now; null: none.
  void show(std::shared_ptr<LiveScene> scene) { scene_ = std::move(scene); }

  /// Result of a message.
  struct Reply {
    bool close = false;  ///< The viewer is to be disconnected.
    std::string notice;  ///< Message to this viewer; empty: none.
  };
  /// Acts on a message of a viewer.
  /// @param text  complete message; empty optional: it was not a text, or too long
  /// @param now_s  wall clock
  Reply receive(int viewer, std::optional<std::string_view> text, double now_s);

  ViewerPlace place_of(int viewer) const;
  long dropped() const { return dropped_; }  ///< Messages beyond the rate.
  long bad() const { return bad_; }          ///< Messages that were not understood.

 private:
  struct Viewer {
    int bad = 0;
    double allowance = 0.0, seen_s = 0.0;  ///< Messages that the rate still permits, at that time.
  };
  bool may_control(int viewer) const { return holder_ == 0 || holder_ == viewer; }
  std::string act(int viewer, const Message& message);
  std::string set(const SetValue& message);
  std::string open(const OpenScene& message);

  Controls& controls_;
  std::vector<std::string> scenes_;
  ViewerLimits limits_;
  std::shared_ptr<LiveScene> scene_;
  std::map<int, Viewer> viewers_;
  int holder_ = 0;  ///< Number of a viewer; 0: nobody.
  int last_ = 0;
  long dropped_ = 0, bad_ = 0;
};

}  // namespace palpate::live
