#pragma once
#include "palpate/scene/description.h"
#include "render/camera.h"

namespace palpate::session {

/// Returns the view of a picture of a scene: that of its [view] table.
/// @param chosen  view used where the table gives no direction (render/seen.h)
render::View scene_view(const scene::ViewSpec& spec, const render::View& chosen = {});

}  // namespace palpate::session
