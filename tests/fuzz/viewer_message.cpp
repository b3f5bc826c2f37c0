// What a browser, or somebody else on this machine, sends to palpate touch.
#include <cmath>

#include "fuzz/input.h"
#include "fuzz/targets.h"
#include "live/access.h"
#include "live/messages.h"

namespace palpate::fuzz {
namespace {

bool is_short_and_printable(const std::string& text) {
  for (const char c : text)
    if ((c >= 0 && c < ' ') || c == '\x7f') return false;
  return !text.empty() && text.size() <= 200;
}

void check(const live::Message& message) {
  if (const auto* move = std::get_if<live::MoveHandle>(&message)) {
    promise(move->target.translation.allFinite() &&
                move->target.translation.cwiseAbs().maxCoeff() <= live::kFarthest,
            "an accepted position is finite and near");
    promise(std::abs(move->target.rotation.norm() - 1.0) < 1e-12, "its quaternion has unit length");
  }
  if (const auto* set = std::get_if<live::SetValue>(&message))
    promise(std::isfinite(set->value) && is_short_and_printable(set->key), "an accepted value is finite");
  if (const auto* open = std::get_if<live::OpenScene>(&message))
    promise(is_short_and_printable(open->scene), "an accepted name is short and printable");
}

}  // namespace

void viewer_message(std::string_view bytes) {
  if (const std::optional<live::Message> message = live::read_message(bytes)) {
    promise(bytes.size() <= live::kLongestMessage, "an accepted message is short");
    check(*message);
  }
  // The same bytes as the headers Host and Origin of a handshake.
  if (live::is_own_host(bytes, true)) promise(live::is_own_host(bytes, false), "loopback is always own");
  promise(!live::is_own_origin(bytes, "") && !live::is_own_origin(bytes, bytes), "an origin has a scheme");
}

}  // namespace palpate::fuzz
