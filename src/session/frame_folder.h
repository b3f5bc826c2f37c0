#pragma once
#include <memory>
#include <string>

#include "session/frame_sink.h"

namespace palpate::session {

/// Returns a sink that writes 0000.png, 0001.png, ... into a folder, each atomically; pictures of an earlier
/// run are removed.
std::unique_ptr<FrameSink> make_frame_folder(const std::string& folder);

}  // namespace palpate::session
