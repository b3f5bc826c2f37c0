#include "live/viewers.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace palpate::live {
namespace {

template <class... Functions>
struct Overloaded : Functions... {
  using Functions::operator()...;
};
template <class... Functions>
Overloaded(Functions...) -> Overloaded<Functions...>;

}  // namespace

Viewers::Viewers(Controls& controls, std::vector<std::string> scenes, const ViewerLimits& limits)
    : controls_(controls), scenes_(std::move(scenes)), limits_(limits) {}

int Viewers::add() {
  viewers_[++last_].allowance = limits_.messages_per_s;
  return last_;
}

void Viewers::remove(int viewer) {
  viewers_.erase(viewer);
  if (holder_ == viewer) holder_ = 0;
}

ViewerPlace Viewers::place_of(int viewer) const {
  return {holder_ == 0 ? "nobody" : holder_ == viewer ? "you" : "other", viewers_.size()};
}

Viewers::Reply Viewers::receive(int viewer, std::optional<std::string_view> text, double now_s) {
  const auto found = viewers_.find(viewer);
  if (found == viewers_.end()) return {true, {}};
  Viewer& v = found->second;
  v.allowance = std::min(limits_.messages_per_s,
                         v.allowance + limits_.messages_per_s * std::max(0.0, now_s - v.seen_s));
  v.seen_s = now_s;
  if (v.allowance < 1.0) {
    ++dropped_;
    return {};
  }
  v.allowance -= 1.0;
  const std::optional<Message> message = text ? read_message(*text) : std::nullopt;
  if (!message) {
    ++bad_;
    return {++v.bad >= limits_.bad_messages, {}};
  }
  return {false, act(viewer, *message)};
}

std::string Viewers::act(int viewer, const Message& message) {
  const auto guarded = [&](const auto& action) -> std::string {
    if (!may_control(viewer)) return notice_text("warning", "another viewer holds the handle");
    return action();
  };
  return std::visit(Overloaded{[&](const TakeHandle&) -> std::string {
                                 if (!scene_ || !scene_->has_hand)
                                   return notice_text(
                                       "warning", "this scene has no hand, so there is no handle to take");
                                 if (!may_control(viewer))
                                   return notice_text("warning", "another viewer holds the handle");
                                 holder_ = viewer;
                                 return {};
                               },
                               [&](const DropHandle&) -> std::string {
                                 if (holder_ == viewer) holder_ = 0;
                                 return {};
                               },
                               [&](const MoveHandle& move) -> std::string {
                                 if (holder_ != viewer || !scene_ || move.hand >= scene_->handles.size())
                                   return {};
                                 if (const auto& handle = scene_->handles[move.hand])
                                   handle->publish(HandleTarget::of(move.target, move.switches));
                                 return {};
                               },
                               [&](const SetValue& value) { return guarded([&] { return set(value); }); },
                               [&](const Reset&) {
                                 return guarded([&] {
                                   controls_.request([](Requests& r) { r.reset = true; });
                                   return std::string();
                                 });
                               },
                               [&](const SetRecording& record) {
                                 return guarded([&] {
                                   controls_.request([&](Requests& r) { r.record = record.on; });
                                   return std::string();
                                 });
                               },
                               [&](const OpenScene& scene) { return guarded([&] { return open(scene); }); },
                               [&](const SetPause& pause) {
                                 return guarded([&] {
                                   controls_.pause() = pause.on;
                                   return std::string();
                                 });
                               }},
                    message);
}

std::string Viewers::set(const SetValue& message) {
  if (!scene_) return notice_text("warning", "no scene is open");
  const auto found = std::find_if(scene_->sliders.begin(), scene_->sliders.end(),
                                  [&](const Slider& slider) { return slider.key == message.key; });
  if (found == scene_->sliders.end())
    return notice_text("warning", fmt::format("the scene has no slider {}", message.key));
  if (message.value < found->least || message.value > found->most)
    return notice_text("warning", fmt::format("{} = {:g} {} must lie in [{:g}, {:g}]", message.key,
                                              message.value, found->unit, found->least, found->most));
  if (scene_->is_recorded)
    return notice_text("warning", "a recording has one set of values: stop it before you change one");
  const auto change = [&](Requests& r) { r.values[message.key] = message.value; };
  if (found->body < 0) {
    controls_.request(change);
    return {};
  }
  scene_->moduli[static_cast<std::size_t>(found->body)] = message.value;
  found->value = message.value;
  scene_->description = with_slider_value(scene_->description, found->key, found->value);
  controls_.note(change);
  return {};
}

std::string Viewers::open(const OpenScene& message) {
  if (std::find(scenes_.begin(), scenes_.end(), message.scene) == scenes_.end())
    return notice_text("warning", fmt::format("there is no scene \"{}\" in the list", message.scene));
  controls_.request([&](Requests& r) { r.open = message.scene; });
  return {};
}

}  // namespace palpate::live
